// The orientation-tensor grid: how much extinction each voxel holds, and across which directions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/base/progress.h"
#include "core/volume/strand_pieces.h"

namespace hairbake {

/// Per voxel the symmetric tensor T = sum over pieces of opacity * width * length * t t^T / h^2, dimensionless. The
/// optical depth of one voxel edge in direction l (unit) is sqrt(tr T * (tr T - l.T.l)), which is exact for combed
/// hair (docs/math.md, "The extinction tensor").
struct ExtinctionBricks {
    static constexpr int voxels = 512;
    static constexpr int components = 6;

    /// Bits of half floats, [(brick * 6 + component) * 512 + voxel]: components xx yy zz xy xz yz, voxels as
    /// GridFrame::voxel_in_brick.
    std::vector<std::uint16_t> half;
    std::uint64_t occupied_voxels = 0;  ///< those with extinction

    const std::uint16_t* component(std::size_t brick, int c) const {
        return half.data() + (brick * components + static_cast<std::size_t>(c)) * voxels;
    }
    /// tr T of the stored halves, as the sweep uses it.
    float trace(std::size_t brick, std::size_t voxel) const;
};

/// The weight (opacity * width / h) with which a piece is deposited.
/// A strand crosses a ray's way through a voxel at most once. The voxel then lets 1 - f through, not e^-f, where f is
/// opacity * width * crossing length * sine / h^2. -ln(1 - f) = f (1 + f / 2 + ...). The average of f / 2, weighted
/// with f, over random lines through a cube is (opacity * width / h) * chord / 2 * (2/3) / (pi/4). There chord = 0.897
/// is the cube's mean chord through a random point. With this term the mean over random placements is
/// e^-(mean extinction), as it must be: E[(1 - f)^n] = e^(-f mean n).
inline float deposited_weight(float weight) { return weight * (1 + 0.381f * weight); }

/// The mean sine of isotropic directions over the root of their mean squared sine: (pi / 4) sqrt(3 / 2).
inline constexpr float isotropic_sine = std::numbers::pi_v<float> / 4 * 1.22474487f;

/// Deposits every piece into the voxel of its centre. The same for any thread count.
/// Throws Error(out_of_resources), Error(cancelled).
ExtinctionBricks deposit_strands(const SortedStrands& sorted, Progress& progress);

}  // namespace hairbake
