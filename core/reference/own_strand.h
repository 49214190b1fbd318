// Self exclusion: the thickness of a strand does not shadow the strand's own vertices.
#pragma once

#include <cstdint>

#include "core/hair/strand_geometry.h"

namespace hairbake {

/// Whether the ray from vertex `v` enters `segment` before it has left the strand of `v`. It does when it passes every
/// joint from `own` to `segment`, one after another, within the strand's radius. (Then it stays inside: a segment with
/// its two joint spheres is convex.)
///
/// own: own_segments(strands, v); must not contain `segment`
/// l:   unit direction of the ray, or zero for the vertex alone
bool enters_from_inside(const StrandGeometry& strands, std::uint32_t v, const OwnSegments& own, std::uint32_t segment,
                        const Vec3f& l);

}  // namespace hairbake
