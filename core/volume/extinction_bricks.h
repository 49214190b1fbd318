// The orientation-tensor grid: how much extinction each voxel holds, and across which directions.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// Deposits every piece into the voxel of its centre. The same for any thread count.
/// Throws Error(out_of_resources), Error(cancelled).
ExtinctionBricks deposit_strands(const SortedStrands& sorted, Progress& progress);

}  // namespace hairbake
