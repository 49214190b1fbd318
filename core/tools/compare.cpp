#include "core/tools/compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/output/manifest.h"
#include "core/output/npy.h"
#include "core/tools/error_statistics.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// Names of the .npy files of a result, without the ending.
std::vector<std::string> arrays_of(const fs::path& folder) {
    std::vector<std::string> names;
    for (const std::string& file : files_of_result(folder)) {
        if (fs::path(file).extension() != ".npy") continue;
        if (fs::path(file).has_parent_path())
            throw Error(ErrorKind::bad_input, (folder / "manifest.json").string() + " lists the file " + file +
                                                  "; allowed are names of files in its folder");
        names.push_back(fs::path(file).stem().string());
    }
    return names;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// The names of the first list, then those that only the second one has.
std::vector<std::string> merged(std::vector<std::string> first, const std::vector<std::string>& second) {
    for (const std::string& name : second)
        if (!has(first, name)) first.push_back(name);
    return first;
}

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
            {"rms_over_largest", largest > 0 ? rms / largest : rms},
            {"max_over_largest", largest > 0 ? largest_difference / largest : largest_difference}};
}

/// Number of cube maps in an array [..., 6, n, n, 3] with leading axes; 0 for any other shape.
std::size_t maps_in(std::span<const std::size_t> shape) {
    if (shape.size() < 5) return 0;
    const auto leading = shape.first(shape.size() - 4), cube = shape.last(4);
    if (cube[0] != 6 || cube[1] != cube[2] || cube[3] != 3) return 0;
    return std::accumulate(leading.begin(), leading.end(), std::size_t{1}, std::multiplies<>());
}

/// The report's entry about one array.
struct Comparison {
    bool same = false;
    Json entries = Json::object();
};

Json sentence(const std::string& name, const std::string& text) { return Json::object({{name, text}}); }

Comparison compare_arrays(const std::string& name, const NpyArray& a, const NpyArray& b) {
    if (a.shape != b.shape)
        return {false, sentence(name, "shapes " + shape_text(a.shape) + " and " + shape_text(b.shape) +
                                          " cannot be compared")};
    Comparison comparison{a.values == b.values};
    const std::size_t maps = maps_in(a.shape);
    if (maps == 0) {
        comparison.entries[name] = statistics(a.values, b.values);
        return comparison;
    }
    const std::size_t size = a.values.size() / maps;
    for (std::size_t m = 0; m < maps; ++m) {
        char number[24];
        std::snprintf(number, sizeof number, "_%02zu", m);
        comparison.entries[name + number] =
            statistics(std::span(a.values).subspan(m * size, size), std::span(b.values).subspan(m * size, size));
    }
    return comparison;
}

/// Whether all entries of an array are statistics whose largest difference is small. A NaN compares as false.
bool within(const Json& entries, double tolerance) {
    return std::all_of(entries.begin(), entries.end(), [&](const Json& entry) {
        return entry.is_object() && entry["max_over_largest"].get<double>() <= tolerance;
    });
}

std::string verdict(const Json& report) {
    if (report["same"].get<bool>()) return "equal";
    char text[64];
    const auto tolerance = report["tolerance"].get<double>();
    std::snprintf(text, sizeof text, tolerance > 0 ? " (tolerance %g)" : "", tolerance);
    return (report["equal"].get<bool>() ? "equal" : "different") + std::string(text);
}

}  // namespace

ComparisonReport compare(const fs::path& first, const fs::path& second, double tolerance) {
    const std::vector<std::string> in_first = arrays_of(first), in_second = arrays_of(second);
    Json report{{"first", first.string()},
                {"second", second.string()},
                {"tolerance", tolerance},
                {"equal", true},
                {"same", true}};
    bool any_in_common = false, same = true, equal = true;
    for (const std::string& name : merged(in_first, in_second)) {
        const bool a = has(in_first, name), b = has(in_second, name);
        Comparison comparison{false, sentence(name, a ? "only in the first" : "only in the second")};
        if (a && b)
            comparison = compare_arrays(name, read_npy(first / (name + ".npy")), read_npy(second / (name + ".npy")));
        any_in_common |= a && b;
        same &= comparison.same;
        equal &= comparison.same || (tolerance > 0 && within(comparison.entries, tolerance));
        // An array must not replace "first", "equal" and so on, whatever its name in the manifest.
        for (const auto& [key, entry] : comparison.entries.items())
            if (!report.contains(key)) report[key] = entry;
    }
    if (!any_in_common)
        throw Error(ErrorKind::bad_input, first.string() + " and " + second.string() +
                                              " have no .npy file in common; bake both with the output npy");
    report["equal"] = equal;
    report["same"] = same;
    return {report.dump(2, ' ', false, Json::error_handler_t::replace), equal};
}

std::string as_table(const std::string& report) {
    const Json object = Json::parse(report);
    std::string table = verdict(object) + ": " + object["first"].get<std::string>() + " and " +
                        object["second"].get<std::string>() + "; the figures are second minus first\n";
    char line[160];
    std::snprintf(line, sizeof line, "%-16s %10s %12s %12s %13s %12s %12s\n", "", "values", "max abs", "rms", "bias",
                  "rms/largest", "max/largest");
    table += line;
    const auto number = [](const Json& value) { return value.is_null() ? std::nan("") : value.get<double>(); };
    for (const auto& [name, item] : object.items()) {
        if (item.is_object())
            std::snprintf(line, sizeof line, "%-16s %10zu %12.4e %12.4e %+13.4e %12.4e %12.4e\n", name.c_str(),
                          item["values"].get<std::size_t>(), number(item["max_abs"]), number(item["rms"]),
                          number(item["bias"]), number(item["rms_over_largest"]), number(item["max_over_largest"]));
        else if (item.is_string() && name != "first" && name != "second")
            std::snprintf(line, sizeof line, "%-16s %s\n", name.c_str(), item.get_ref<const std::string&>().c_str());
        else
            continue;
        table += line;
    }
    return table;
}

}  // namespace hairbake
