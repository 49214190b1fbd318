#include "core/hair/hair_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <new>
#include <system_error>

#include "core/base/error.h"
#include "core/hair/hair_header.h"

namespace hairbake {
namespace {

constexpr float largest_coordinate = 1e18f;

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
    throw Error(ErrorKind::bad_input, name + ": " + what);
}

/// A file's bytes, in order. `take(to, n)` copies the next n, or throws when there are fewer.
struct Source {
    std::string name;
    std::uint64_t size = 0;
    std::function<void(void*, std::size_t)> take;

    template <class T>
    std::vector<T> array(std::size_t count) const {
        std::vector<T> values(count);
        if (count > 0) take(values.data(), count * sizeof(T));
        return values;
    }
};

std::uint64_t size_of_file(const HairHeader& h) {
    const std::uint64_t strands = h.strands, points = h.points;  // 128 + 34 * 2^32 at most: no overflow
    return sizeof(HairHeader) + (h.arrays & has_segments ? 2 * strands : 0) + 12 * points +
           (h.arrays & has_thickness ? 4 * points : 0) + (h.arrays & has_transparency ? 4 * points : 0) +
           (h.arrays & has_colors ? 12 * points : 0);
}

std::string counts_of(const HairHeader& h) {
    return std::to_string(h.strands) + " strands and " + std::to_string(h.points) + " points";
}

/// Everything that can be checked before memory is taken for the arrays.
HairHeader read_header(const Source& source) {
    if (source.size < sizeof(HairHeader))
        refuse(source.name, "the file has " + std::to_string(source.size) + " bytes; a HAIR header alone has 128");
    HairHeader h;
    source.take(&h, sizeof h);
    if (h.magic != HairHeader{}.magic)
        refuse(source.name, "the first four bytes are not \"HAIR\": this is no HAIR file");
    if (h.arrays & ~known_arrays)
        refuse(source.name, "header, array bits: found " + std::to_string(h.arrays) +
                                "; only bits 0 to 4 (values up to 31) have a meaning");
    if (!(h.arrays & has_points))
        refuse(source.name,
               "header, array bits: bit 1 is not set, so there is no points array; the format demands one");
    if (const std::uint64_t expected = size_of_file(h); expected != source.size)
        refuse(source.name, std::string(source.size < expected ? "truncated" : "over-long") + ": the header declares " +
                                counts_of(h) + ", which with its arrays make " + std::to_string(expected) +
                                " bytes; the file has " + std::to_string(source.size));
    if (!(h.arrays & has_segments) && h.strands * (std::uint64_t{h.default_segments} + 1) != h.points)
        refuse(source.name, "header: " + counts_of(h) + " disagree with " + std::to_string(h.default_segments) +
                                " segments for every strand, which make " +
                                std::to_string(h.strands * (std::uint64_t{h.default_segments} + 1)) + " points");
    return h;
}

/// First point of every strand, and the number of points at the end.
std::vector<std::uint32_t> read_strands(const Source& source, const HairHeader& h) {
    std::vector<std::uint32_t> begin(std::size_t{h.strands} + 1, 0);
    if (!(h.arrays & has_segments)) {
        for (std::size_t s = 0; s < h.strands; ++s) begin[s + 1] = begin[s] + h.default_segments + 1;
        return begin;
    }
    const auto segments = source.array<std::uint16_t>(h.strands);
    std::uint64_t points = 0;
    for (std::size_t s = 0; s < h.strands; ++s) {
        points += segments[s] + 1u;
        if (points > h.points)
            refuse(source.name, "strand " + std::to_string(s) + ": the segments array asks for " +
                                    std::to_string(points) + " points up to here; the header declares " +
                                    std::to_string(h.points));
        begin[s + 1] = static_cast<std::uint32_t>(points);
    }
    if (points != h.points)
        refuse(source.name, "the segments array makes " + std::to_string(points) + " points; the header declares " +
                                std::to_string(h.points));
    return begin;
}

void check_numbers(const Source& source, const HairModel& model) {
    const auto at = [&](std::size_t i, const char* what, float found, const char* allowed) {
        refuse(source.name, place_of_point(model, i) + ": " + what + " is " + std::to_string(found) + "; " + allowed);
    };
    for (std::size_t i = 0; i < model.positions.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            if (const float c = model.positions[i][axis]; !(std::abs(c) <= largest_coordinate))
                at(i, axis == 0 ? "x" : axis == 1 ? "y" : "z", c, "allowed are finite numbers up to 1e18 in magnitude");
    for (std::size_t i = 0; i < model.thickness.size(); ++i)
        if (!std::isfinite(model.thickness[i])) at(i, "the thickness", model.thickness[i], "it must be finite");
    for (std::size_t i = 0; i < model.transparency.size(); ++i)
        if (!std::isfinite(model.transparency[i]))
            at(i, "the transparency", model.transparency[i], "it must be finite");
    for (std::size_t i = 0; i < model.colors.size(); ++i)
        for (int channel = 0; channel < 3; ++channel)
            if (const float c = model.colors[i][channel]; !std::isfinite(c))
                at(i, "the colour", c, "it must be finite");

    // A default counts only where its array is missing: writers leave junk in the others.
    const auto check_default = [&](bool used, const char* what, bool finite) {
        if (used && !finite)
            refuse(source.name, std::string("header: the default ") + what + " is not a finite number");
    };
    check_default(model.thickness.empty(), "thickness", std::isfinite(model.default_thickness));
    check_default(model.transparency.empty(), "transparency", std::isfinite(model.default_transparency));
    check_default(model.colors.empty(), "colour", is_finite(model.default_color));
}

HairModel read(const Source& source) {
    const HairHeader h = read_header(source);
    HairModel model;
    model.strand_begin = read_strands(source, h);
    model.positions = source.array<Vec3f>(h.points);
    if (h.arrays & has_thickness) model.thickness = source.array<float>(h.points);
    if (h.arrays & has_transparency) model.transparency = source.array<float>(h.points);
    if (h.arrays & has_colors) model.colors = source.array<Vec3f>(h.points);
    model.has_segments_array = h.arrays & has_segments;
    model.default_segments = h.default_segments;
    model.default_thickness = h.default_thickness;
    model.default_transparency = h.default_transparency;
    model.default_color = h.default_color;
    model.info = h.info;
    if (h.points == 0) model.empty_arrays = h.arrays & (has_thickness | has_transparency | has_colors);
    check_numbers(source, model);
    return model;
}

}  // namespace

HairModel read_hair(const std::filesystem::path& file) {
    const std::string name = file.string();
    std::error_code problem;
    const auto status = std::filesystem::status(file, problem);
    if (!std::filesystem::exists(status)) refuse(name, "there is no such file");
    if (!std::filesystem::is_regular_file(status)) refuse(name, "this is not a regular file");
    const std::uint64_t size = std::filesystem::file_size(file, problem);
    std::ifstream stream(file, std::ios::binary);
    if (problem || !stream) refuse(name, "the file cannot be opened: " + std::generic_category().message(errno));
    try {
        return read({name, size, [&](void* to, std::size_t n) {
                         if (!stream.read(static_cast<char*>(to), static_cast<std::streamsize>(n)))
                             refuse(name, "the file could not be read to its end");
                     }});
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::out_of_resources,
                    name + ": not enough memory for a file of " + std::to_string(size) + " bytes");
    }
}

HairModel read_hair(std::span<const std::byte> bytes, const std::string& name) {
    std::size_t at = 0;
    return read({name, bytes.size(), [&](void* to, std::size_t n) {
                     if (n > bytes.size() - at) refuse(name, "the file could not be read to its end");
                     std::memcpy(to, bytes.data() + at, n);
                     at += n;
                 }});
}

}  // namespace hairbake
