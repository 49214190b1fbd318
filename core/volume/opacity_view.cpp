#include "core/volume/opacity_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/assert.h"

namespace hairbake {
namespace {

/// Lowest and highest of the points along three axes.
struct Extent {
    Vec3d low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

    void add(const Vec3d& p) {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
};

Extent extent_of(std::span<const Vec3f> points, const OpacityView& view) {
    Extent extent;
    for (const Vec3f& p : points) {
        const Vec3d q(p);
        extent.add({dot(q, view.u), dot(q, view.v), -dot(q, view.l)});
    }
    return extent;
}

}  // namespace

OpacityView make_opacity_view(std::span<const Vec3f> points, const Vec3d& l, const OpacityMapSettings& settings,
                              double least_texel) {
    HAIRBAKE_ASSERT(!points.empty() && least_texel > 0);
    OpacityView view;
    view.l = l;
    // Any axis that is not nearly parallel to l.
    view.u = normalized(cross(std::abs(l.y) < 0.9 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0), l));
    view.v = cross(l, view.u);
    const Extent extent = extent_of(points, view);
    const Vec3d side = extent.high - extent.low;
    // A margin of one texel on each side makes sure that the four texels around a point exist. The factor above 1 keeps
    // rounding from adding a texel.
    view.texel_size = std::max(std::max(side.x, side.y) * (1 + 1e-9) / (settings.resolution - 2), least_texel);
    view.scale = 1 / view.texel_size;
    view.origin_u = extent.low.x - view.texel_size;
    view.origin_v = extent.low.y - view.texel_size;
    view.origin_z = extent.low.z;
    view.width = static_cast<int>(side.x * view.scale) + 3;
    view.height = static_cast<int>(side.y * view.scale) + 3;

    double thickness = 1, sum = 0;
    for (int k = 0; k < settings.layers; ++k, thickness *= settings.layer_spacing)
        view.layer_end.push_back(static_cast<float>(sum += thickness));
    for (float& end : view.layer_end) end *= static_cast<float>(side.z * view.scale / sum);
    return view;
}

}  // namespace hairbake
