#include "core/hair/tfx_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/hair/hair_format_writer.h"

namespace hairbake {
namespace {

/// The headers as they lie in the file.
struct Header4 {
    float version;
    std::uint32_t strands, points, positions, strand_uv, vertex_uv, thickness, colors;
    std::array<std::uint32_t, 32> reserved;
};
struct Header3 {
    float version;
    std::uint32_t strands, points, follow_hairs, both_ends_immovable;
    std::array<std::uint32_t, 31> reserved1;
    std::uint32_t positions, thickness, strand_uv, colors, guides, vertex_uv;
    std::array<std::uint32_t, 32> reserved2;
};
static_assert(std::endian::native == std::endian::little, "TressFX files are copied to memory as they are");
static_assert(sizeof(Header4) == 160 && sizeof(Header3) == 296);

/// The fields of either header that are read.
struct Contents {
    float version = 0;
    std::uint64_t header_bytes = 0;
    std::uint64_t strands = 0, points = 0;    ///< points of each strand
    std::uint64_t positions = 0, colors = 0;  ///< offsets
    std::uint64_t floats_a_position = 0;
    std::uint32_t follow_hairs = 0;
};

template <class Header>
Header read_header(const HairSource& source, const char* version) {
    if (source.size < sizeof(Header))
        refuse_hair(source.name, "the file has " + std::to_string(source.size) + " bytes; a TressFX " + version +
                                     " header alone has " + std::to_string(sizeof(Header)));
    Header header;
    source.copy(0, &header, sizeof header);
    return header;
}

Contents read_contents(const HairSource& source) {
    float version = 0;
    if (source.size < sizeof version)
        refuse_hair(source.name, "the file has " + std::to_string(source.size) +
                                     " bytes; a TressFX header alone has 160 (version 4.0) or 296 (3.0)");
    source.copy(0, &version, sizeof version);
    if (version == 4) {
        const auto h = read_header<Header4>(source, "4.0");
        return {h.version, sizeof h, h.strands, h.points, h.positions, h.colors, 4, 0};
    }
    if (version == 3) {
        const auto h = read_header<Header3>(source, "3.0");
        return {h.version, sizeof h, h.strands, h.points, h.positions, h.colors, 3, h.follow_hairs};
    }
    refuse_hair(source.name, "header, version: found " + std::to_string(version) +
                                 "; read are the binary TressFX versions 3.0 and 4.0");
}

/// Runs before memory is taken. No product overflows: counts are below 2^32, and 16 * count is formed only after the
/// file's size has bounded count.
void check_counts(const HairSource& source, const Contents& c) {
    const std::string counts = std::to_string(c.strands) + " strands of " + std::to_string(c.points) + " points";
    if (c.strands > 0 && c.points == 0) refuse_hair(source.name, "header: " + counts + "; a strand has at least one");
    const std::uint64_t count = c.strands * c.points;
    if (count > source.size / (4 * c.floats_a_position))
        refuse_hair(source.name, "truncated: the header declares " + counts + ", whose positions alone need " +
                                     std::to_string(4 * c.floats_a_position) + " bytes each; the file has " +
                                     std::to_string(source.size));
    if (count > std::numeric_limits<std::uint32_t>::max())
        refuse_hair(source.name, "header: " + counts + " are more than 4294967295 points");
}

void check_array(const HairSource& source, const Contents& c, const char* what, std::uint64_t offset,
                 std::uint64_t bytes) {
    if (offset >= c.header_bytes && offset <= source.size && bytes <= source.size - offset) return;
    refuse_hair(source.name, std::string("header, offset of the ") + what + ": found " + std::to_string(offset) +
                                 "; the array has " + std::to_string(bytes) + " bytes and lies between the header's " +
                                 std::to_string(c.header_bytes) + " bytes and the file's end at " +
                                 std::to_string(source.size));
}

/// The first three of each `stride` floats, `count` times.
std::vector<Vec3f> read_triples(const HairSource& source, std::uint64_t offset, std::size_t count, std::size_t stride) {
    std::vector<Vec3f> triples;
    triples.reserve(count);
    constexpr std::size_t block = 1 << 16;
    for (std::size_t done = 0; done < count; done += block) {
        const std::size_t n = std::min(block, count - done);
        const auto floats = source.array<float>(offset + 4 * stride * done, n * stride);
        for (std::size_t i = 0; i < n; ++i)
            triples.emplace_back(floats[i * stride], floats[i * stride + 1], floats[i * stride + 2]);
    }
    return triples;
}

bool begins_as_tfx(std::span<const std::byte> bytes) {
    float version = 0;
    if (bytes.size() < sizeof version) return false;
    std::memcpy(&version, bytes.data(), sizeof version);
    return version == 3 || version == 4;
}

std::string format_of(const Contents& c) { return c.version == 4 ? "TressFX 4.0" : "TressFX 3.0"; }

std::string description_of(const Contents& c) {
    std::string text = "from " + format_of(c);
    if (c.follow_hairs > 0) text += ", without its " + std::to_string(c.follow_hairs) + " follow hairs a guide";
    return text;
}

/// First point of each strand, and the number of points at the end.
std::vector<std::uint32_t> strands_of(const Contents& c) {
    std::vector<std::uint32_t> begin(static_cast<std::size_t>(c.strands) + 1);
    for (std::size_t s = 0; s < begin.size(); ++s) begin[s] = static_cast<std::uint32_t>(s * c.points);
    return begin;
}

/// The header, after its counts and offsets were checked.
Contents checked_contents(const HairSource& source) {
    const Contents c = read_contents(source);
    check_counts(source, c);
    const std::uint64_t count = c.strands * c.points;
    if (count > 0) check_array(source, c, "positions", c.positions, 4 * c.floats_a_position * count);
    if (c.colors != 0) check_array(source, c, "vertex colours", c.colors, 16 * count);
    return c;
}

void check_tfx(const HairSource& source) { checked_contents(source); }

HairModel read_model(const HairSource& source, const Contents& c) {
    const auto count = static_cast<std::size_t>(c.strands * c.points);
    HairModel model;
    model.format = format_of(c);
    model.strand_begin = strands_of(c);
    model.positions = read_triples(source, c.positions, count, c.floats_a_position);
    if (c.colors != 0) model.colors = read_triples(source, c.colors, count, 4);
    check_numbers(source.name, model);
    return model;
}

Groom read_tfx(const HairSource& source, const HairReadSettings&) {
    const Contents contents = checked_contents(source);
    Groom groom;
    groom.model = read_model(source, contents);
    groom.description = description_of(contents);
    groom.extras = make_hair_file_extras(groom.model, groom.description);
    // Every strand has the same number of points. So the HAIR form needs no segments array, which ends at 65,536.
    groom.extras.has_segments_array = false;
    groom.extras.default_segments = contents.points > 0 ? static_cast<std::uint32_t>(contents.points - 1) : 0;
    return groom;
}

}  // namespace

const HairReader tfx_reader{
    .name = "TressFX",
    .extension = ".tfx",
    .beginning = "the version 3.0 or 4.0 of a TressFX file (a float)",
    .animated = false,
    .recognises = begins_as_tfx,
    .check = check_tfx,
    .read = read_tfx,
};

}  // namespace hairbake
