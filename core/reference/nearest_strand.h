// The distance from a vertex to the nearest other strand.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hair/strand_geometry.h"

namespace hairbake {

/// For each of `vertices` the distance to the surface of the nearest solid segment, in units of the vertex's width:
/// negative inside another strand, at most `limit`. The vertex's adjacent segments do not count, nor those joined to it
/// inside the strand's own thickness (segments shorter than half a width). The same for any thread count.
///
/// vertices: indices of the strands' points
/// limit:    widths of the vertex
///
/// (Embree's point queries do not support curves. This search is made for a few thousand vertices among millions of
/// segments.)
std::vector<float> distance_to_other_strands(const StrandGeometry& strands, std::span<const std::uint32_t> vertices,
                                             float limit);

}  // namespace hairbake
