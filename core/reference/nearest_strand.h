// How near other strands come to a vertex.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hair/strand_geometry.h"

namespace hairbake {

/// For each of `vertices` (indices of the strands' points): distance from the vertex to the surface of the nearest
/// solid segment that is neither adjacent to it nor joined to it inside the strand's own thickness (segments shorter
/// than half a width), in units of the vertex's width; negative inside another strand, at most `limit`. (Embree's point
/// queries do not see curves, so this is a search of our own, made for a few thousand vertices among millions of
/// segments.) The same for any thread count.
std::vector<float> distance_to_other_strands(const StrandGeometry& strands, std::span<const std::uint32_t> vertices,
                                             float limit);

}  // namespace hairbake
