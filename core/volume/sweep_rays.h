// The rays of one direction: a lattice that shifts with the light from slice to slice.
#pragma once

#include <array>
#include <cmath>

#include "core/base/vec.h"
#include "core/volume/slice_layout.h"

namespace hairbake {

/// Ray (U, V) lies in voxel column (U + shift(slope_u, s), V + shift(slope_v, s)) at the middle of slice s. The rays
/// stored are [base_u, base_u + stride) x [base_v, base_v + rows), U fastest; they pass every voxel of the grid.
struct SweepRays {
    float slope_u, slope_v;       ///< d u / d s, d v / d s
    float per_slice;              ///< length of a ray inside one slice, in voxels
    std::array<float, 6> square;  ///< l l^T, off-diagonal entries doubled: l.T.l = square . T
    int base_u, base_v;
    int stride, rows;

    std::size_t count() const { return static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows); }
    static int shift(float slope, int s) {
        return static_cast<int>(std::floor((static_cast<float>(s) + 0.5f) * slope + 0.5f));
    }
};

/// `l`: unit direction away from the hair whose largest component is that of layout.axis.
SweepRays make_sweep_rays(const SliceLayout& layout, const Vec3d& l);

}  // namespace hairbake
