#include "core/tools/diff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/error.h"
#include "core/base/short_number.h"
#include "core/environment/image_file.h"
#include "core/output/canvas.h"
#include "core/output/file_sink.h"
#include "core/output/picture_encoding.h"
#include "core/tools/error_statistics.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

double largest(const Vec3f& v) { return worse(worse(std::abs(v.x), std::abs(v.y)), std::abs(v.z)); }

/// Sums over the channels of some pixels.
struct Sums {
    std::uint64_t pixels = 0;
    double squares = 0, difference = 0, first = 0;

    void add(const Vec3f& a, const Vec3f& b) {
        ++pixels;
        for (int channel = 0; channel < 3; ++channel) {
            const double d = double(b[channel]) - double(a[channel]);
            squares += d * d;
            difference += d;
            first += double(a[channel]);
        }
    }
    double values() const { return 3.0 * double(std::max<std::uint64_t>(1, pixels)); }
    double rmse() const { return std::sqrt(squares / values()); }
    double mean() const { return first / values(); }
    Json relative() const { return mean() != 0 ? Json(rmse() / mean()) : Json(); }
};

std::string fault_of_size(int width, int height) {
    constexpr int most = 16384;
    if (width >= 1 && height >= 1 && width <= most && height <= most) return {};
    return "the size is " + std::to_string(width) + " x " + std::to_string(height) +
           "; allowed are 1 to 16384 pixels each";
}

/// Checks both pictures by their headers: that they are linear and of one size.
void check_pictures(const std::filesystem::path& first, const std::filesystem::path& second) {
    const auto facts_of = [](const std::filesystem::path& file) {
        ImageFile image = read_image_facts(file, fault_of_size);
        if (!image.integer) return image;
        throw Error(ErrorKind::bad_input,
                    file.string() + " holds integers; allowed are linear pictures in floating point (OpenEXR)");
    };
    const ImageFile a = facts_of(first), b = facts_of(second);
    if (a.width == b.width && a.height == b.height) return;
    throw Error(ErrorKind::bad_input, second.string() + " is " + std::to_string(b.width) + " x " +
                                          std::to_string(b.height) + " pixels; allowed is the size of " +
                                          first.string() + ", " + std::to_string(a.width) + " x " +
                                          std::to_string(a.height));
}

/// The next of 1, 2 and 5 times a power of ten; 1 where there is none.
double rounded_up(double value) {
    if (!(value > 0) || !std::isfinite(value)) return 1;
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 2.0, 5.0})
        if (value <= step * power * (1 + 1e-9)) return step * power;
    return 10 * power;
}

/// Black at 0, then blue, red and yellow, white at 1; green for NaN.
Color false_color(double share) {
    if (std::isnan(share)) return {0, 255, 0};
    constexpr std::array<std::array<double, 3>, 6> stops{
        {{0, 0, 0}, {40, 40, 150}, {165, 40, 120}, {235, 85, 45}, {252, 200, 60}, {255, 255, 255}}};
    const double at = std::clamp(share, 0.0, 1.0) * (stops.size() - 1);
    const auto k = std::min<std::size_t>(static_cast<std::size_t>(at), stops.size() - 2);
    Color color{};
    for (int channel = 0; channel < 3; ++channel)
        color[channel] = static_cast<std::uint8_t>(
            std::lround(stops[k][channel] + (at - double(k)) * (stops[k + 1][channel] - stops[k][channel])));
    return color;
}

void write_false_colors(const std::vector<Vec3f>& difference, int width, int height, double scale,
                        const std::filesystem::path& file) {
    constexpr int legend = 34, margin = 6;
    Canvas canvas(width, height + legend, {22, 24, 28});
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            canvas.set(x, y, false_color(largest(difference[static_cast<std::size_t>(y) * width + x]) / scale));
    const int bar = width - 2 * margin;
    for (int x = 0; x < bar; ++x)
        canvas.fill(margin + x, height + margin, 1, 10, false_color(double(x) / std::max(1, bar - 1)));
    char label[40];
    std::snprintf(label, sizeof label, "%.3g", scale);
    constexpr Color text{200, 204, 210};
    canvas.text(margin, height + legend - 5, "0", 11, text);
    canvas.text(width / 2, height + legend - 5, "absolute difference", 11, text, Canvas::Align::center);
    canvas.text(width - margin, height + legend - 5, label, 11, text, Canvas::Align::right);
    write_whole_file(file, encode_png(canvas.rgb(), canvas.width(), canvas.height(), {}));
}

void check_arguments(const std::optional<std::filesystem::path>& picture, std::optional<double> scale) {
    if (picture && picture->extension() != ".png")
        throw Error(ErrorKind::usage, "out is " + picture->string() + "; allowed is a name that ends in .png", "out");
    if (scale && !(*scale > 0 && std::isfinite(*scale)))
        throw Error(ErrorKind::usage, "scale is " + short_number(*scale) + "; allowed is a positive number", "scale");
}

struct Difference {
    std::vector<Vec3f> pixels;  ///< second - first
    double maximum = 0;         ///< of the absolute values
    Sums all, lit;              ///< lit: the pixels where either picture is not black
};

/// The pictures have the same size.
Difference difference_of(const ImageFile& a, const ImageFile& b) {
    Difference difference;
    difference.pixels.reserve(a.pixels.size());
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        difference.pixels.push_back(b.pixels[i] - a.pixels[i]);
        difference.maximum = worse(difference.maximum, largest(difference.pixels.back()));
        difference.all.add(a.pixels[i], b.pixels[i]);
        if (a.pixels[i] != Vec3f() || b.pixels[i] != Vec3f()) difference.lit.add(a.pixels[i], b.pixels[i]);
    }
    return difference;
}

}  // namespace

std::string diff(const std::filesystem::path& first, const std::filesystem::path& second,
                 const std::optional<std::filesystem::path>& picture, std::optional<double> scale, Progress& progress) {
    check_arguments(picture, scale);
    check_pictures(first, second);
    if (picture) prove_file_writable(*picture);
    const ImageFile a = read_image_file(first, fault_of_size, progress);
    const ImageFile b = read_image_file(second, fault_of_size, progress);
    const Difference difference = difference_of(a, b);
    const Sums &all = difference.all, &lit = difference.lit;
    Json report{{"first", first.string()},
                {"second", second.string()},
                {"width", a.width},
                {"height", a.height},
                {"rmse", all.rmse()},
                {"max_abs", difference.maximum},
                {"bias", all.difference / all.values()},
                {"mean", all.mean()},
                {"rmse_over_mean", all.relative()},
                {"lit",
                 {{"pixels", lit.pixels},
                  {"rmse", lit.rmse()},
                  {"bias", lit.difference / lit.values()},
                  {"mean", lit.mean()},
                  {"rmse_over_mean", lit.relative()}}}};
    if (picture) {
        const double shown = scale.value_or(rounded_up(difference.maximum));
        write_false_colors(difference.pixels, a.width, a.height, shown, *picture);
        report["scale"] = shown;
    }
    return report.dump(2, ' ', false, Json::error_handler_t::replace);
}

void discard_diff_part(const std::filesystem::path& picture) noexcept { discard_part(picture); }

std::string diff_as_lines(const std::string& report) {
    const Json object = Json::parse(report);
    const auto number = [](const Json& value) { return value.is_number() ? value.get<double>() : std::nan(""); };
    const Json& lit = object["lit"];
    char text[512];
    std::snprintf(text, sizeof text,
                  "RMSE            %.6g (%.3g %% of the first's mean)\n"
                  "RMSE where lit  %.6g (%.3g %% of the mean there), %llu of %llu pixels\n"
                  "bias            %+.6g\n"
                  "maximum         %.6g\n",
                  number(object["rmse"]), 100 * number(object["rmse_over_mean"]), number(lit["rmse"]),
                  100 * number(lit["rmse_over_mean"]), lit["pixels"].get<unsigned long long>(),
                  object["width"].get<unsigned long long>() * object["height"].get<unsigned long long>(),
                  number(object["bias"]), number(object["max_abs"]));
    std::string lines = text;
    if (object.contains("scale")) {
        std::snprintf(text, sizeof text, "scale           0 to %.6g\n", number(object["scale"]));
        lines += text;
    }
    return lines;
}

}  // namespace hairbake
