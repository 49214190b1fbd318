#include "core/volume/hair_shadow.h"

#include <algorithm>

namespace hairbake {

HairShadow::HairShadow(const StrandGeometry& strands, const TriangleMesh& occluder, Progress& progress)
    : strands_(strands),
      grounded_(ground_points(strands.positions, occluder, shadow_scale(strands.positions, occluder), progress)),
      occluder_(occluder, shadow_scale(strands.positions, occluder), strands.bounds_min, strands.bounds_max) {}

OccluderShadow::Points HairShadow::points(const SliceLayout& layout, const SortedStrands& sorted) const {
    const auto is_padding = [&](std::size_t slot) { return layout.slot_vertex[slot] == SliceLayout::no_vertex; };
    const auto vertex = [&](std::size_t slot) { return sorted.vertices[layout.slot_vertex[slot]]; };
    const auto position = [&](std::size_t slot) { return strands_.positions[is_padding(slot) ? 0 : vertex(slot)]; };
    const auto grounded = [&](std::size_t slot) -> const GroundedPoint* {
        if (is_padding(slot)) return nullptr;
        const std::uint32_t v = vertex(slot);
        const auto found = std::lower_bound(grounded_.begin(), grounded_.end(), v,
                                            [](const GroundedPoint& g, std::uint32_t w) { return g.point < w; });
        return found != grounded_.end() && found->point == v ? &*found : nullptr;
    };
    return occluder_.points(layout.slot_vertex.size(), position, grounded);
}

}  // namespace hairbake
