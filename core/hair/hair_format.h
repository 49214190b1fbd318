// Cem Yuksel's HAIR format: its header, its reader and its writer's shared parts. Private to core/hair.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>

#include "core/base/vec.h"
#include "core/hair/hair_reader.h"

namespace hairbake {

/// Bits of HairHeader::arrays: which arrays follow the header, in this order.
inline constexpr std::uint32_t has_segments = 1;      ///< uint16 a strand: its points less one
inline constexpr std::uint32_t has_points = 2;        ///< three floats a point
inline constexpr std::uint32_t has_thickness = 4;     ///< a float a point
inline constexpr std::uint32_t has_transparency = 8;  ///< a float a point
inline constexpr std::uint32_t has_colors = 16;       ///< three floats a point
inline constexpr std::uint32_t known_arrays = 31;

/// The first 128 bytes as they lie in the file, little-endian.
struct HairHeader {
    std::array<char, 4> magic{'H', 'A', 'I', 'R'};
    std::uint32_t strands = 0, points = 0, arrays = has_points, default_segments = 0;
    float default_thickness = 0, default_transparency = 0;
    Vec3f default_color;
    std::array<char, 88> info{};
};

static_assert(std::endian::native == std::endian::little, "HAIR files are copied to and from memory as they are");
static_assert(sizeof(HairHeader) == 128 && sizeof(Vec3f) == 12 && std::is_trivially_copyable_v<HairHeader>);

/// Reads every combination of the array bits that has the points array, which the format demands. The file
/// must have exactly the length that its header implies.
extern const HairReader hair_format_reader;

}  // namespace hairbake
