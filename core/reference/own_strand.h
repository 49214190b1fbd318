// Self exclusion: a strand does not shadow its own vertices through its own thickness.
#pragma once

#include <cstdint>

#include "core/hair/strand_geometry.h"

namespace hairbake {

/// Whether the ray from vertex `v` in direction `l` (unit, or zero for the vertex alone) enters `segment` before it has
/// left the strand of `v`: it passes every joint from the adjacent segments `own` of `v` to `segment`, one after
/// another, within the strand's radius. (Then it stays inside: a piece with its two joint spheres is convex.)
bool enters_from_inside(const StrandGeometry& strands, std::uint32_t v, const AdjacentSegments& own,
                        std::uint32_t segment, const Vec3f& l);

}  // namespace hairbake
