// Crossings of a ray with strands. Each entry into a strand is one crossing, for any number of segments.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hair/strand_geometry.h"

namespace hairbake {

/// Product of (1 - opacity) over the crossings of a ray. Parts of the ray inside segments of one strand that overlap
/// are one crossing.
///
/// origin, l: of the ray; l is a unit vector
/// hit:       the solid segments that the ray meets, in any order, repeated or not; gets sorted, repetitions removed
float transmittance_of_crossings(const StrandGeometry& strands, const Vec3f& origin, const Vec3f& l,
                                 std::vector<std::uint32_t>& hit);

}  // namespace hairbake
