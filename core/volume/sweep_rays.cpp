#include "core/volume/sweep_rays.h"

#include <algorithm>
#include <cstddef>

#include "core/base/assert.h"

namespace hairbake {
namespace {

struct Span {
    int base, count;
};

/// The rays along one lattice axis that meet any of `size` columns in any slice, with a margin of two rays.
Span covering(float slope, int slices, int size) {
    const int first = SweepRays::shift(slope, 0), last = SweepRays::shift(slope, slices - 1);
    const int base = -std::max(first, last) - 2;
    return {base, size - std::min(first, last) + 2 - base};
}

}  // namespace

SweepRays make_sweep_rays(const SliceLayout& layout, const Vec3d& l) {
    const double major = l[layout.axis];
    HAIRBAKE_ASSERT(std::abs(major) >= std::abs(l[layout.axis_u]) && std::abs(major) >= std::abs(l[layout.axis_v]));
    SweepRays rays;
    rays.slope_u = static_cast<float>(l[layout.axis_u] / major);
    rays.slope_v = static_cast<float>(l[layout.axis_v] / major);
    rays.per_slice = static_cast<float>(1 / std::abs(major));
    const Vec3f f(l);
    rays.square = {f.x * f.x, f.y * f.y, f.z * f.z, 2 * f.x * f.y, 2 * f.x * f.z, 2 * f.y * f.z};
    const Span u = covering(rays.slope_u, layout.slices, layout.size_u),
               v = covering(rays.slope_v, layout.slices, layout.size_v);
    rays.base_u = u.base;
    rays.stride = u.count;
    rays.base_v = v.base;
    rays.rows = v.count;
    return rays;
}

}  // namespace hairbake
