#include "core/hair/hair_format_writer.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <limits>
#include <ostream>
#include <string>
#include <system_error>
#include <vector>

#include "core/base/error.h"
#include "core/hair/hair_format.h"

namespace hairbake {
namespace {

void check(bool ok, const std::string& what) {
    if (!ok) throw Error(ErrorKind::internal, "a hair model cannot be written as a HAIR file: " + what);
}

void check_arrays(const HairModel& model) {
    const std::size_t v = model.vertex_count();
    check(v <= std::numeric_limits<std::uint32_t>::max(), "it has more than 2^32 - 1 points");
    check(model.thickness.empty() || model.thickness.size() == v,
          "its thickness array does not have one value for each point");
    check(model.transparency.empty() || model.transparency.size() == v,
          "its transparency array does not have one value for each point");
    check(model.colors.empty() || model.colors.size() == v, "its colour array does not have one value for each point");
    check(model.strand_begin.empty() ? v == 0 : model.strand_begin.front() == 0 && model.strand_begin.back() == v,
          "its strands do not cover its points");
}

/// Number of segments of each strand.
std::vector<std::uint16_t> segments_of(const HairModel& model) {
    std::vector<std::uint16_t> segments(model.strand_count());
    for (std::size_t s = 0; s < segments.size(); ++s) {
        const std::uint32_t begin = model.strand_begin[s], end = model.strand_begin[s + 1];
        check(
            begin < end && end - begin <= 65536,
            "strand " + std::to_string(s) + " has " + std::to_string(end - begin) + " points; allowed are 1 to 65,536");
        segments[s] = static_cast<std::uint16_t>(end - begin - 1);
    }
    return segments;
}

void check_default_segments(const HairModel& model, std::uint32_t default_segments) {
    for (std::size_t s = 0; s < model.strand_count(); ++s)
        check(std::uint64_t{model.strand_begin[s]} + default_segments + 1 == model.strand_begin[s + 1],
              "strand " + std::to_string(s) +
                  " does not have the default number of segments, and there is no segments array");
}

HairHeader header_of(const HairModel& model, const HairFileExtras& extras) {
    HairHeader h;
    h.strands = static_cast<std::uint32_t>(model.strand_count());
    h.points = static_cast<std::uint32_t>(model.vertex_count());
    h.arrays = has_points | extras.empty_arrays;
    if (extras.has_segments_array) h.arrays |= has_segments;
    if (!model.thickness.empty()) h.arrays |= has_thickness;
    if (!model.transparency.empty()) h.arrays |= has_transparency;
    if (!model.colors.empty()) h.arrays |= has_colors;
    h.default_segments = extras.default_segments;
    // A default that is not used, because the file has the array, is written as it was read.
    const auto used = [&](std::uint32_t array) { return !(h.arrays & array); };
    h.default_thickness = used(has_thickness) ? model.default_thickness : extras.default_thickness;
    h.default_transparency = used(has_transparency) ? model.default_transparency : extras.default_transparency;
    h.default_color = used(has_colors) ? model.default_color : extras.default_color;
    h.info = extras.info;
    return h;
}

template <class T>
void put(std::ostream& stream, const std::vector<T>& values) {
    stream.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
}

}  // namespace

void write_hair(const HairModel& model, std::ostream& stream, const HairFileExtras& extras) {
    check_arrays(model);
    const HairHeader header = header_of(model, extras);
    stream.write(reinterpret_cast<const char*>(&header), sizeof header);
    if (extras.has_segments_array)
        put(stream, segments_of(model));
    else
        check_default_segments(model, extras.default_segments);
    put(stream, model.positions);
    put(stream, model.thickness);
    put(stream, model.transparency);
    put(stream, model.colors);
}

void write_hair(const HairModel& model, const std::filesystem::path& file, const HairFileExtras& extras) {
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    if (stream) write_hair(model, stream, extras);
    stream.close();
    if (!stream)
        throw Error(ErrorKind::out_of_resources,
                    file.string() + ": could not be written whole: " + std::generic_category().message(errno));
}

HairModel with_transmittance_as_colors(const HairModel& model, std::span<const float> transmittance) {
    check(transmittance.size() == model.vertex_count(), "there is not one transmittance value for each point");
    HairModel result = model;
    result.colors.clear();
    result.colors.reserve(transmittance.size());
    for (const float a : transmittance) result.colors.emplace_back(a);
    return result;
}

HairFileExtras make_hair_file_extras(const HairModel& model, std::string_view info) {
    HairFileExtras extras;
    std::copy_n(info.begin(), std::min(info.size(), extras.info.size()), extras.info.begin());
    extras.default_thickness = model.default_thickness;
    extras.default_transparency = model.default_transparency;
    extras.default_color = model.default_color;
    return extras;
}

}  // namespace hairbake
