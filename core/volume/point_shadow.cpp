#include "core/volume/point_shadow.h"

#include <algorithm>
#include <utility>

namespace hairbake {
namespace {

/// Corners of the box of `points`; the origin for none.
std::pair<Vec3f, Vec3f> bounds_of(std::span<const Vec3f> points) {
    if (points.empty()) return {};
    std::pair<Vec3f, Vec3f> bounds{points[0], points[0]};
    for (const Vec3f& p : points)
        for (int axis = 0; axis < 3; ++axis) {
            bounds.first[axis] = std::min(bounds.first[axis], p[axis]);
            bounds.second[axis] = std::max(bounds.second[axis], p[axis]);
        }
    return bounds;
}

OccluderShadow shadow_for(std::span<const Vec3f> positions, const TriangleMesh& occluder, const ShadowScale& scale) {
    const auto [low, high] = bounds_of(positions);
    return {occluder, scale, low, high};
}

}  // namespace

PointShadow::PointShadow(std::span<const Vec3f> positions, const TriangleMesh& occluder, const ShadowScale& scale,
                         Progress& progress)
    : positions_(positions),
      grounded_(ground_points(positions, occluder, scale, progress)),
      occluder_(shadow_for(positions, occluder, scale)) {}

OccluderShadow::Points PointShadow::points(std::span<const std::uint32_t> point_of_slot) const {
    const auto is_padding = [&](std::size_t slot) { return point_of_slot[slot] >= positions_.size(); };
    const auto position = [&](std::size_t slot) { return positions_[is_padding(slot) ? 0 : point_of_slot[slot]]; };
    const auto grounded = [&](std::size_t slot) -> const GroundedPoint* {
        if (is_padding(slot)) return nullptr;
        const std::uint32_t point = point_of_slot[slot];
        const auto found = std::lower_bound(grounded_.begin(), grounded_.end(), point,
                                            [](const GroundedPoint& g, std::uint32_t p) { return g.point < p; });
        return found != grounded_.end() && found->point == point ? &*found : nullptr;
    };
    return occluder_.points(point_of_slot.size(), position, grounded);
}

}  // namespace hairbake
