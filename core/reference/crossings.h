// How many times a ray crosses strands: once for each time that it enters one, whatever the number of segments.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hair/strand_geometry.h"

namespace hairbake {

/// Product of (1 - opacity) over the crossings of the ray from `origin` in direction `l` (unit) with the strands of the
/// solid segments `hit`, which it meets; repetitions do not matter. The ways through a strand's segments that overlap
/// along the ray are one crossing. `hit` is sorted and thinned.
float transmittance_of_crossings(const StrandGeometry& strands, const Vec3f& origin, const Vec3f& l,
                                 std::vector<std::uint32_t>& hit);

}  // namespace hairbake
