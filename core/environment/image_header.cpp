#include "core/environment/image_header.h"

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace hairbake {
namespace {

[[noreturn]] void fail(const std::string& what) { throw std::invalid_argument(what); }

/// The next line without its end (LF or CR LF); null at the end of `text`.
std::optional<std::string_view> take_line(std::string_view text, std::size_t& place) {
    const std::size_t end = text.find('\n', place);
    if (end == std::string_view::npos) return std::nullopt;
    std::string_view line = text.substr(place, end - place);
    place = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

/// The text after "NAME=", with any spaces around the sign; null for another variable.
std::optional<std::string> value_of(std::string_view line, std::string_view name) {
    if (!line.starts_with(name)) return std::nullopt;
    const std::size_t sign = line.find_first_not_of(" \t", name.size());
    if (sign == std::string_view::npos || line[sign] != '=') return std::nullopt;
    const std::size_t begin = line.find_first_not_of(" \t", sign + 1);
    return std::string(begin == std::string_view::npos ? std::string_view() : line.substr(begin));
}

template <std::size_t count>
std::array<double, count> numbers(const std::string& text, const std::string& name) {
    std::istringstream stream(text);
    stream.imbue(std::locale::classic());
    std::array<double, count> values{};
    for (double& value : values)
        if (!(stream >> value))
            fail("the header's " + name + " is \"" + text.substr(0, 60) + "\"; allowed are " + std::to_string(count) +
                 " numbers");
    return values;
}

void take_exposure(ImageHeader& header, const Vec3d& factor, const std::string& name) {
    for (int channel = 0; channel < 3; ++channel)
        if (!(factor[channel] > 0) || !std::isfinite(factor[channel]))
            fail("the header's " + name + " is " + std::to_string(factor[channel]) + "; allowed is above 0");
    header.exposure = header.exposure * factor;
}

void take_variable(ImageHeader& header, std::string_view line) {
    if (const auto format = value_of(line, "FORMAT")) {
        header.xyz = *format == "32-bit_rle_xyze";
        if (!header.xyz && *format != "32-bit_rle_rgbe")
            fail("the header's FORMAT is " + format->substr(0, 60) +
                 "; allowed are 32-bit_rle_rgbe and 32-bit_rle_xyze");
    }
    if (const auto text = value_of(line, "EXPOSURE")) {
        const double exposure = numbers<1>(*text, "EXPOSURE")[0];
        take_exposure(header, Vec3d(exposure), "EXPOSURE");
    }
    if (const auto text = value_of(line, "COLORCORR")) {
        const auto c = numbers<3>(*text, "COLORCORR");
        take_exposure(header, {c[0], c[1], c[2]}, "COLORCORR");
    }
    if (const auto text = value_of(line, "PRIMARIES")) {
        const auto xy = numbers<8>(*text, "PRIMARIES");
        Chromaticities primaries;
        for (std::size_t i = 0; i < xy.size(); ++i) primaries[i] = static_cast<float>(xy[i]);
        header.primaries = primaries;
    }
}

struct Resolution {
    AxisOrder order;
    long scan_lines = 0, scan_line_pixels = 0;
};

/// "-Y 512 +X 1024" and its seven relatives.
Resolution read_resolution(std::string_view line) {
    std::istringstream stream{std::string(line)};
    std::string first, second, rest;
    Resolution found;
    const bool ok = static_cast<bool>(stream >> first >> found.scan_lines >> second >> found.scan_line_pixels) &&
                    !(stream >> rest) && first.size() == 2 && second.size() == 2;
    const auto is_sign = [](char c) { return c == '+' || c == '-'; };
    if (!ok || !is_sign(first[0]) || !is_sign(second[0]) ||
        !((first[1] == 'X' && second[1] == 'Y') || (first[1] == 'Y' && second[1] == 'X')))
        fail("the line of the size is \"" + std::string(line.substr(0, 60)) +
             "\"; allowed is, for example, "
             "\"-Y 512 +X 1024\"");
    found.order.columns = first[1] == 'X';
    const std::string& x = found.order.columns ? first : second;
    const std::string& y = found.order.columns ? second : first;
    found.order.from_right = x[0] == '-';
    found.order.from_bottom = y[0] == '+';
    return found;
}

/// Radiance's first run-length code, before 1991: a pixel (1, 1, 1, n) repeats the one before n times.
void refuse_old_runs(std::string_view start, const ImageHeader& header, const Resolution& size,
                     std::uintmax_t file_bytes) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(start[i]); };
    const std::size_t begin = header.data_begin;
    if (start.size() < begin + 4) return;
    const bool new_code = byte(begin) == 2 && byte(begin + 1) == 2 && byte(begin + 2) < 128;
    const auto pixels = static_cast<double>(size.scan_lines) * static_cast<double>(size.scan_line_pixels);
    if (new_code || static_cast<double>(file_bytes - begin) >= 4 * pixels) return;
    for (std::size_t i = begin; i + 4 <= start.size(); i += 4)
        if (byte(i) == 1 && byte(i + 1) == 1 && byte(i + 2) == 1)
            fail(
                "the pixels are in the run-length code that Radiance wrote before 1991; write the file again, for "
                "example with ra_rgbe of Radiance");
}

}  // namespace

ImageHeader read_radiance_header(std::string_view start, std::uintmax_t file_bytes) {
    ImageHeader header;
    std::size_t place = 0;
    (void)take_line(start, place);  // "#?RADIANCE"
    while (true) {
        const auto line = take_line(start, place);
        if (!line) fail("the header has no end (an empty line) within its first 64 KiB");
        if (line->empty()) break;
        take_variable(header, *line);
    }
    const auto line = take_line(start, place);
    if (!line) fail("the header has no line of the size");
    const Resolution size = read_resolution(*line);
    if (header.xyz) header.primaries = radiance_chromaticities;  // of the RGB that the XYZ become
    header.order = size.order;
    header.data_begin = place;
    refuse_old_runs(start, header, size, file_bytes);
    header.text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(size.scan_lines) + " +X " +
                  std::to_string(size.scan_line_pixels) + "\n";
    return header;
}

std::optional<ImageHeader> read_pfm_header(std::string_view start) {
    // Three lines, and comments between them.
    std::size_t place = 0;
    std::string text;
    bool has_cr = false;
    for (int lines = 0; lines < 3;) {
        const std::size_t begin = place;
        const auto line = take_line(start, place);
        if (!line) return std::nullopt;
        has_cr |= place - begin == line->size() + 2;
        if (line->starts_with('#')) continue;
        text += std::string(*line) + "\n";
        ++lines;
    }
    if (!has_cr) return std::nullopt;
    ImageHeader header;
    header.text = text;
    header.data_begin = place;
    return header;
}

void put_in_order(const AxisOrder& order, int width, int height, std::vector<Vec3f>& pixels) {
    if (order.is_usual()) return;
    std::vector<Vec3f> placed(pixels.size());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int column = order.from_right ? width - 1 - x : x;
            const int row = order.from_bottom ? height - 1 - y : y;
            const std::size_t stored = order.columns ? static_cast<std::size_t>(column) * height + row
                                                     : static_cast<std::size_t>(row) * width + column;
            placed[static_cast<std::size_t>(y) * width + x] = pixels[stored];
        }
    pixels = std::move(placed);
}

std::string take_off_exposure(const ImageHeader& header, std::vector<Vec3f>& pixels) {
    const Vec3d& e = header.exposure;
    if (e == Vec3d(1)) return {};
    for (Vec3f& p : pixels)
        p = {static_cast<float>(p.x / e.x), static_cast<float>(p.y / e.y), static_cast<float>(p.z / e.z)};
    std::ostringstream text;
    text << "the pixels were divided by the header's exposure and colour correction (" << e.x << ' ' << e.y << ' '
         << e.z << "), which gives the radiance";
    return text.str();
}

std::string take_xyz(const ImageHeader& header, std::vector<Vec3f>& pixels) {
    if (!header.xyz) return {};
    constexpr double lumens_a_watt = 179;  // WHTEFFICACY of Radiance
    const auto matrix = rgb_from_xyz(radiance_chromaticities);
    for (Vec3f& p : pixels) {
        const Vec3d xyz = Vec3d(p) / lumens_a_watt;
        p = {static_cast<float>(dot(matrix[0], xyz)), static_cast<float>(dot(matrix[1], xyz)),
             static_cast<float>(dot(matrix[2], xyz))};
    }
    return "the file holds CIE XYZ in candelas: they were converted to RGB of Radiance's primaries in watts (179 "
           "lumens "
           "a watt)";
}

}  // namespace hairbake
