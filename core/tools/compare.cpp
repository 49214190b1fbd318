#include "core/tools/compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <span>

#include "core/base/error.h"
#include "core/output/manifest.h"
#include "core/output/npy.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

bool has(const std::vector<std::string>& files, const std::string& name) {
    return std::find(files.begin(), files.end(), name) != files.end();
}

/// The larger of the two; a NaN once met stays, which std::max would lose.
double worse(double worst, double value) { return std::isnan(worst) || value <= worst ? worst : value; }

/// The two arrays have the same size. A NaN on either side makes every figure NaN (null in JSON).
Json statistics(std::span<const float> first, std::span<const float> second) {
    double largest_difference = 0, squares = 0, sum = 0, largest = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        const double difference = double(second[i]) - double(first[i]);
        largest_difference = worse(largest_difference, std::abs(difference));
        largest = worse(largest, std::abs(first[i]));
        squares += difference * difference;
        sum += difference;
    }
    const double count = static_cast<double>(std::max<std::size_t>(1, first.size()));
    const double rms = std::sqrt(squares / count);
    return {{"values", first.size()},
            {"max_abs", largest_difference},
            {"rms", rms},
            {"bias", sum / count},
            {"largest", largest},
            {"rms_over_largest", largest > 0 ? rms / largest : rms}};
}

std::string shape_text(const std::vector<std::size_t>& shape) {
    std::string text = "[";
    for (const std::size_t n : shape) text += (text.size() > 1 ? ", " : "") + std::to_string(n);
    return text + "]";
}

void compare_file(const fs::path& first, const fs::path& second, const std::string& name, Json& report) {
    const NpyArray a = read_npy(first / (name + ".npy")), b = read_npy(second / (name + ".npy"));
    if (a.shape != b.shape) {
        report[name] = "shapes " + shape_text(a.shape) + " and " + shape_text(b.shape) + " cannot be compared";
        report["same"] = false;
        return;
    }
    report["same"] = report["same"].get<bool>() && a.values == b.values;
    if (name != "specular") {
        report[name] = statistics(a.values, b.values);
        return;
    }
    const std::size_t maps = a.shape.empty() ? 0 : a.shape[0], size = maps > 0 ? a.values.size() / maps : 0;
    for (std::size_t m = 0; m < maps; ++m) {
        char label[32];
        std::snprintf(label, sizeof label, "specular_%02zu", m);
        report[label] =
            statistics(std::span(a.values).subspan(m * size, size), std::span(b.values).subspan(m * size, size));
    }
}

}  // namespace

std::string compare(const fs::path& first, const fs::path& second) {
    const std::vector<std::string> in_first = files_of_result(first), in_second = files_of_result(second);
    Json report{{"first", first.string()}, {"second", second.string()}, {"same", true}};
    bool any = false;  // file in common
    for (const std::string name : {"transmittance", "diffuse", "specular"}) {
        const bool a = has(in_first, name + ".npy"), b = has(in_second, name + ".npy");
        if (a != b) {
            report[name] = a ? "only in the first" : "only in the second";
            report["same"] = false;
        }
        if (!a || !b) continue;
        compare_file(first, second, name, report);
        any = true;
    }
    if (!any)
        throw Error(ErrorKind::bad_input, first.string() + " and " + second.string() +
                                              " have no .npy file in common; bake both with the output npy");
    return report.dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string as_table(const std::string& report) {
    const Json object = Json::parse(report);
    std::string table = object["first"].get<std::string>() + " and " + object["second"].get<std::string>() +
                        (object["same"].get<bool>() ? ": all values are equal\n" : ": second minus first\n");
    char line[160];
    std::snprintf(line, sizeof line, "%-16s %10s %12s %12s %13s %12s\n", "", "values", "max abs", "rms", "bias",
                  "rms/largest");
    table += line;
    const auto number = [](const Json& value) { return value.is_null() ? std::nan("") : value.get<double>(); };
    for (const auto& [name, item] : object.items()) {
        if (item.is_object())
            std::snprintf(line, sizeof line, "%-16s %10zu %12.4e %12.4e %+13.4e %12.4e\n", name.c_str(),
                          item["values"].get<std::size_t>(), number(item["max_abs"]), number(item["rms"]),
                          number(item["bias"]), number(item["rms_over_largest"]));
        else if (item.is_string() && name != "first" && name != "second")
            std::snprintf(line, sizeof line, "%-16s %s\n", name.c_str(), item.get_ref<const std::string&>().c_str());
        else
            continue;
        table += line;
    }
    return table;
}

}  // namespace hairbake
