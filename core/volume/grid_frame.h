// The place of the voxels: the map between model space and grid space.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/hair/strand_geometry.h"
#include "core/visibility/transmittance_settings.h"

namespace hairbake {

/// What decided the size of the voxels.
enum class VoxelReason {
    asked,       ///< the request's voxels or voxel_size
    spacing,     ///< auto: the distance between strands
    resolution,  ///< auto: the number of directions
    width        ///< the widths of the strands, in place of what was asked for
};

/// Grid space has its origin at `origin`, one voxel per unit, and the model's axes. Voxel (i, j, k) covers
/// [i, i + 1) x [j, j + 1) x [k, k + 1). Bricks are blocks of 8^3 voxels, the leaves of OpenVDB.
struct GridFrame {
    static constexpr int brick_side = 8;

    Vec3f origin;               ///< model space
    double voxel_size = 1;      ///< h, model units
    std::array<int, 3> bricks;  ///< per axis
    VoxelReason reason = VoxelReason::asked;

    Vec3f to_grid(const Vec3f& p) const { return (p - origin) * static_cast<float>(1 / voxel_size); }
    int voxels(int axis) const { return bricks[axis] * brick_side; }
    std::uint32_t brick_count() const {
        return static_cast<std::uint32_t>(bricks[0]) * static_cast<std::uint32_t>(bricks[1]) *
               static_cast<std::uint32_t>(bricks[2]);
    }
    /// Linear index of the brick that holds voxel (i, j, k).
    std::uint32_t brick_of(int i, int j, int k) const {
        return (static_cast<std::uint32_t>(i >> 3) * static_cast<std::uint32_t>(bricks[1]) +
                static_cast<std::uint32_t>(j >> 3)) *
                   static_cast<std::uint32_t>(bricks[2]) +
               static_cast<std::uint32_t>(k >> 3);
    }
    /// Linear index of the brick that holds grid position g.
    std::uint32_t brick_at(const Vec3f& g) const {
        return brick_of(static_cast<int>(g.x), static_cast<int>(g.y), static_cast<int>(g.z));
    }
    /// Brick coordinates of a linear brick index.
    std::array<int, 3> brick_coordinates(std::uint32_t linear) const {
        const auto ny = static_cast<std::uint32_t>(bricks[1]), nz = static_cast<std::uint32_t>(bricks[2]);
        return {static_cast<int>(linear / (ny * nz)), static_cast<int>(linear / nz % ny),
                static_cast<int>(linear % nz)};
    }
    /// Position of voxel (i, j, k) inside its brick, as in an OpenVDB leaf: z fastest.
    static int voxel_in_brick(int i, int j, int k) { return (i & 7) << 6 | (j & 7) << 3 | (k & 7); }
};

/// 95th percentile of `widths` (not empty).
double typical_largest_width(const std::vector<float>& widths);

/// The grid that `settings` asks for around all strands (at least one vertex), with a margin of one voxel. The mean
/// field needs strands well thinner than a voxel: h = max(size asked for, 2 * 95th percentile of the widths).
///
/// `voxels` auto is a function of the model and the number of directions alone: h = max(0.8 * spacing, longest side /
/// n), n = 25.6 sqrt(directions), at most 512. Voxels much finer than the distance between strands (strand_spacing.h)
/// hold single strands, which the mean field takes for a mist: the error rises (docs/math.md, section 8). More voxels
/// than n gain little on dense hair.
/// Throws Error(usage) for voxels out of range and for more than 1,024 voxels on the longest axis.
/// Throws Error(bad_input) for bounds that no grid can hold.
/// Throws Error(out_of_resources) for 2^31 vertices or more.
/// Throws Error(cancelled).
GridFrame make_grid_frame(const StrandGeometry& strands, const TransmittanceSettings& settings,
                          const Progress& progress = Progress());

}  // namespace hairbake
