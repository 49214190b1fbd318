// Generates one strand of a sample groom. Private to the groom generator.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/random.h"
#include "core/base/vec.h"
#include "core/sample/groom_generator.h"

namespace hairbake {

inline constexpr float root_width_cm = 0.01f;

/// A separate sequence of random numbers for each (seed, kind, index).
inline Random stream_of(std::uint64_t seed, std::uint64_t kind, std::uint64_t index) {
    return Random(Random(seed).next_u64() ^ Random(~kind).next_u64() ^ (Random(index).next_u64() << 1));
}

/// Fills the points (cm, root first) and diameters (cm) of strand `index`, rooted in direction `root` of the head.
void grow_strand(GroomStyle style, std::uint64_t seed, std::uint64_t index, const Vec3d& root, std::span<Vec3f> points,
                 std::span<float> widths);

}  // namespace hairbake
