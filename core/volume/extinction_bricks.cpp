#include "core/volume/extinction_bricks.h"

#include <Imath/half.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"

namespace hairbake {
namespace {

/// One voxel while it is filled: the six components, padded to a power of two.
using Tensor = std::array<float, 8>;

/// Adds the tensor of a piece: weight * length * t t^T.
void add_piece(const StrandPiece& piece, Tensor& sum) {
    const Vec3f& step = piece.step;
    const Vec3f s = deposited_weight(piece.weight) / length(step) * step;
    const Tensor added{s.x * step.x, s.y * step.y, s.z * step.z, s.x * step.y, s.x * step.z, s.y * step.z, 0, 0};
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += added[c];
}

/// sqrt(tr (tr - l.T.l)) is exact where all strands of a voxel are parallel (tr T^2 = tr^2). Elsewhere it is too large:
/// by sqrt(2/3) / (pi/4) in isotropic voxels (tr T^2 = tr^2 / 3). The factor removes the excess; it is linear in tr T^2
/// between these two cases.
float mixing_factor(const Tensor& t) {
    const float tr = t[0] + t[1] + t[2];
    const float square = t[0] * t[0] + t[1] * t[1] + t[2] * t[2] + 2 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]);
    const float combed = std::clamp((square / (tr * tr) - 1.0f / 3) * 1.5f, 0.0f, 1.0f);
    return isotropic_sine + (1 - isotropic_sine) * combed;
}

/// Larger values are opaque many times over; 60,000 stays below infinity after rounding to a half float.
float to_storable(float value) { return std::clamp(value, -60000.0f, 60000.0f); }

/// Returns whether the voxel has extinction after rounding.
bool store_voxel(const Tensor& tensor, std::size_t brick, std::size_t voxel, ExtinctionBricks& out) {
    const float trace = tensor[0] + tensor[1] + tensor[2];
    if (!(trace > 0)) return false;
    const float factor = mixing_factor(tensor);
    for (std::size_t c = 0; c < ExtinctionBricks::components; ++c) {
        const Imath::half half(to_storable(factor * tensor[c]));
        out.half[(brick * ExtinctionBricks::components + c) * ExtinctionBricks::voxels + voxel] = half.bits();
    }
    return out.trace(brick, voxel) > 0;
}

/// Returns the number of the brick's occupied voxels.
std::uint64_t fill_brick(const SortedStrands& sorted, std::size_t brick, ExtinctionBricks& out) {
    std::uint64_t occupied = 0;
    for (std::size_t voxel = 0; voxel < ExtinctionBricks::voxels; ++voxel) {
        const auto pieces = sorted.pieces_in(brick, voxel);
        if (pieces.empty()) continue;
        Tensor sum{};
        for (const StrandPiece& piece : pieces) add_piece(piece, sum);
        occupied += store_voxel(sum, brick, voxel, out) ? 1 : 0;
    }
    return occupied;
}

}  // namespace

float ExtinctionBricks::trace(std::size_t brick, std::size_t voxel) const {
    float sum = 0;
    for (int c = 0; c < 3; ++c) {
        Imath::half value;
        value.setBits(component(brick, c)[voxel]);
        sum += value;
    }
    return sum;
}

ExtinctionBricks deposit_strands(const SortedStrands& sorted, Progress& progress) {
    ExtinctionBricks bricks;
    bricks.half.resize(sorted.brick_count() * ExtinctionBricks::components * ExtinctionBricks::voxels);
    std::atomic<std::uint64_t> occupied{0};
    parallel_for(sorted.brick_count(), 16, [&](std::size_t begin, std::size_t end) {
        progress.check();
        std::uint64_t of_piece = 0;
        for (std::size_t b = begin; b < end; ++b) of_piece += fill_brick(sorted, b, bricks);
        occupied += of_piece;
    });
    bricks.occupied_voxels = occupied;
    return bricks;
}

}  // namespace hairbake
