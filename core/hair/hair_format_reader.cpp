#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "core/hair/hair_format.h"

namespace hairbake {
namespace {

bool begins_as_hair(std::span<const std::byte> bytes) {
    constexpr std::array<char, 4> magic = HairHeader{}.magic;
    return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

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
HairHeader read_header(const HairSource& source) {
    if (source.size < sizeof(HairHeader))
        refuse_hair(source.name, "the file has " + std::to_string(source.size) + " bytes; a HAIR header alone has 128");
    HairHeader h;
    source.copy(0, &h, sizeof h);
    if (h.magic != HairHeader{}.magic) refuse_beginning(source);
    if (h.arrays & ~known_arrays)
        refuse_hair(source.name, "header, array bits: found " + std::to_string(h.arrays) +
                                     "; only bits 0 to 4 (values up to 31) have a meaning");
    if (!(h.arrays & has_points))
        refuse_hair(source.name,
                    "header, array bits: bit 1 is not set, so there is no points array; the format demands one");
    if (const std::uint64_t expected = size_of_file(h); expected != source.size)
        refuse_hair(source.name, std::string(source.size < expected ? "truncated" : "over-long") +
                                     ": the header declares " + counts_of(h) + ", which with its arrays make " +
                                     std::to_string(expected) + " bytes; the file has " + std::to_string(source.size));
    if (!(h.arrays & has_segments) && h.strands * (std::uint64_t{h.default_segments} + 1) != h.points)
        refuse_hair(source.name, "header: " + counts_of(h) + " disagree with " + std::to_string(h.default_segments) +
                                     " segments for every strand, which make " +
                                     std::to_string(h.strands * (std::uint64_t{h.default_segments} + 1)) + " points");
    return h;
}

/// Reads one array after another behind the header.
class Arrays {
public:
    explicit Arrays(const HairSource& source) : source_(source) {}

    template <class T>
    std::vector<T> next(std::size_t count) {
        auto values = source_.array<T>(offset_, count);
        offset_ += count * sizeof(T);
        return values;
    }

private:
    const HairSource& source_;
    std::uint64_t offset_ = sizeof(HairHeader);
};

/// First point of every strand, and the number of points at the end.
std::vector<std::uint32_t> read_strands(const HairSource& source, const HairHeader& h, Arrays& arrays) {
    std::vector<std::uint32_t> begin(std::size_t{h.strands} + 1, 0);
    if (!(h.arrays & has_segments)) {
        for (std::size_t s = 0; s < h.strands; ++s) begin[s + 1] = begin[s] + h.default_segments + 1;
        return begin;
    }
    const auto segments = arrays.next<std::uint16_t>(h.strands);
    std::uint64_t points = 0;
    for (std::size_t s = 0; s < h.strands; ++s) {
        points += segments[s] + 1u;
        if (points > h.points)
            refuse_hair(source.name, "strand " + std::to_string(s) + ": the segments array asks for " +
                                         std::to_string(points) + " points up to here; the header declares " +
                                         std::to_string(h.points));
        begin[s + 1] = static_cast<std::uint32_t>(points);
    }
    if (points != h.points)
        refuse_hair(source.name, "the segments array makes " + std::to_string(points) +
                                     " points; the header declares " + std::to_string(h.points));
    return begin;
}

HairFileExtras extras_of(const HairHeader& h) {
    HairFileExtras extras;
    extras.info = h.info;
    extras.has_segments_array = h.arrays & has_segments;
    extras.default_segments = h.default_segments;
    extras.default_thickness = h.default_thickness;
    extras.default_transparency = h.default_transparency;
    extras.default_color = h.default_color;
    if (h.points == 0) extras.empty_arrays = h.arrays & (has_thickness | has_transparency | has_colors);
    return extras;
}

HairModel read_model(const HairSource& source, const HairHeader& h) {
    Arrays arrays(source);
    HairModel model;
    model.strand_begin = read_strands(source, h, arrays);
    model.positions = arrays.next<Vec3f>(h.points);
    if (h.arrays & has_thickness) model.thickness = arrays.next<float>(h.points);
    if (h.arrays & has_transparency) model.transparency = arrays.next<float>(h.points);
    if (h.arrays & has_colors) model.colors = arrays.next<Vec3f>(h.points);
    // Where a file has an array, the default of that array holds junk.
    if (model.thickness.empty()) model.default_thickness = h.default_thickness;
    if (model.transparency.empty()) model.default_transparency = h.default_transparency;
    if (model.colors.empty()) model.default_color = h.default_color;
    check_numbers(source.name, model);
    return model;
}

void check_hair_format(const HairSource& source) { read_header(source); }

Groom read_hair_format(const HairSource& source, const HairReadSettings&) {
    const HairHeader header = read_header(source);
    Groom groom;
    groom.model = read_model(source, header);
    groom.extras = extras_of(header);
    groom.description.assign(header.info.begin(), std::find(header.info.begin(), header.info.end(), '\0'));
    return groom;
}

}  // namespace

const HairReader hair_format_reader{
    .name = "HAIR",
    .extension = ".hair",
    .beginning = "\"HAIR\"",
    .animated = false,
    .recognises = begins_as_hair,
    .check = check_hair_format,
    .read = read_hair_format,
};

}  // namespace hairbake
