// The orientation-tensor grid: how much extinction each voxel holds, and across which directions.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/volume/strand_pieces.h"

namespace hairbake {

/// Per voxel the symmetric tensor T = sum over pieces of opacity * width * length * t t^T / h^2, dimensionless: the
/// optical depth of one voxel edge in direction l (unit) is sqrt(tr T * (tr T - l.T.l)), which is exact for
/// combed hair. Stored as half floats bits, component-major: half[(brick * 6 + component) * 512 + voxel],
/// components xx yy zz xy xz yz, voxels as GridFrame::voxel_in_brick.
struct ExtinctionBricks {
    static constexpr int voxels = 512;
    static constexpr int components = 6;

    std::vector<std::uint16_t> half;
    std::vector<float> trace;  ///< [brick * 512 + voxel], of the halves: exactly what the sweep uses

    const std::uint16_t* component(std::size_t brick, int c) const {
        return half.data() + (brick * components + static_cast<std::size_t>(c)) * voxels;
    }
};

/// Deposits every piece into the voxel of its centre. Throws Error(out_of_resources), Error(cancelled).
ExtinctionBricks deposit_strands(const SortedStrands& sorted, Progress& progress);

}  // namespace hairbake
