#include "core/mesh/grounding.h"

#include <algorithm>

#include "core/base/parallel.h"
#include "core/mesh/mesh_topology.h"
#include "core/mesh/triangle_tree.h"

namespace hairbake {
namespace {

double longest_side(std::span<const Vec3f> points) {
    if (points.empty()) return 0;
    Vec3d low(points[0]), high = low;
    for (const Vec3f& p : points)
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], double{p[axis]});
            high[axis] = std::max(high[axis], double{p[axis]});
        }
    const Vec3d side = high - low;
    return std::max({side.x, side.y, side.z});
}

constexpr std::size_t kGrain = 4096;

}  // namespace

ShadowScale shadow_scale(std::span<const Vec3f> points, const TriangleMesh& occluder) {
    for (const double side : {longest_side(points), longest_side(occluder.positions)})
        if (side > 0) return {side};
    return {};
}

std::vector<GroundedPoint> ground_points(std::span<const Vec3f> points, const TriangleMesh& occluder,
                                         const ShadowScale& scale, Progress& progress) {
    const TriangleTree tree(occluder);
    const double outward = topology_of(occluder).inside_out ? -1 : 1;
    std::vector<std::vector<GroundedPoint>> parts((points.size() + kGrain - 1) / kGrain);
    parallel_for(points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3d p(points[i]);
            const auto nearest = tree.nearest(p, scale.reach());
            if (!nearest) continue;
            const Vec3d normal = nearest->normal * outward;
            const bool above = dot(p - nearest->point, normal) > 0;
            if (above && nearest->distance > scale.lift()) continue;
            parts[begin / kGrain].push_back(
                {static_cast<std::uint32_t>(i), Vec3f(nearest->point + normal * scale.lift()), Vec3f(normal)});
        }
    });
    std::vector<GroundedPoint> grounded;
    for (const auto& part : parts) grounded.insert(grounded.end(), part.begin(), part.end());
    return grounded;
}

}  // namespace hairbake
