#include "core/volume/extinction_bricks.h"

#include <Imath/half.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"

namespace hairbake {
namespace {

/// One voxel while it is filled: the six components, padded to a power of two.
using Tensor = std::array<float, 8>;

/// The tensor that one piece of `segment` adds.
Tensor tensor_of_piece(const StrandGeometry& strands, const GridFrame& frame, std::uint32_t segment) {
    const Vec3f step = cut_segment(strands, frame, segment).step;
    const float width = 0.5f * (strands.widths[segment] + strands.widths[segment + 1]);
    const float opacity = 0.5f * (strands.opacities[segment] + strands.opacities[segment + 1]);
    const float weight = opacity * width / static_cast<float>(frame.voxel_size) / length(step);
    const Vec3f s = weight * step;
    return {s.x * step.x, s.y * step.y, s.z * step.z, s.x * step.y, s.x * step.z, s.y * step.z, 0, 0};
}

/// sqrt(tr (tr - l.T.l)) is exact where all strands of a voxel are parallel (tr T^2 = tr^2) and too large where they are
/// not: by sqrt(2/3) / (pi/4) in isotropic voxels (tr T^2 = tr^2 / 3). The factor, linear in tr T^2 between
/// these two cases, takes the excess out.
float mixing_factor(const Tensor& t) {
    const float tr = t[0] + t[1] + t[2];
    const float square = t[0] * t[0] + t[1] * t[1] + t[2] * t[2] + 2 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]);
    const float combed = std::clamp((square / (tr * tr) - 1.0f / 3) * 1.5f, 0.0f, 1.0f);
    constexpr float isotropic = std::numbers::pi_v<float> / 4 * 1.22474487f;  // pi/4 * sqrt(3/2)
    return isotropic + (1 - isotropic) * combed;
}

/// Brighter than any half float would be opaque many times over; 60,000 stays clear of infinity after rounding.
float to_storable(float value) { return std::clamp(value, -60000.0f, 60000.0f); }

void store_voxel(const Tensor& tensor, std::size_t brick, std::size_t voxel, ExtinctionBricks& out) {
    const float trace = tensor[0] + tensor[1] + tensor[2];
    const float factor = trace > 0 ? mixing_factor(tensor) : 0;
    float stored_trace = 0;
    for (std::size_t c = 0; c < ExtinctionBricks::components; ++c) {
        const Imath::half half(to_storable(factor * tensor[c]));
        out.half[(brick * ExtinctionBricks::components + c) * ExtinctionBricks::voxels + voxel] = half.bits();
        if (c < 3) stored_trace += half;
    }
    out.trace[brick * ExtinctionBricks::voxels + voxel] = stored_trace;
}

void fill_brick(const StrandGeometry& strands, const GridFrame& frame, const SortedStrands& sorted, std::size_t brick,
                ExtinctionBricks& out) {
    std::array<Tensor, ExtinctionBricks::voxels> voxels{};
    std::uint32_t segment = ~0u;
    Tensor piece{};
    for (std::size_t p = sorted.piece_begin[brick]; p < sorted.piece_begin[brick + 1]; ++p) {
        if (sorted.pieces[p].segment != segment) {
            segment = sorted.pieces[p].segment;
            piece = tensor_of_piece(strands, frame, segment);
        }
        Tensor& voxel = voxels[sorted.pieces[p].voxel];
        for (std::size_t c = 0; c < voxel.size(); ++c) voxel[c] += piece[c];
    }
    for (std::size_t v = 0; v < voxels.size(); ++v)
        if (voxels[v][0] + voxels[v][1] + voxels[v][2] > 0) store_voxel(voxels[v], brick, v, out);
}

}  // namespace

ExtinctionBricks deposit_strands(const StrandGeometry& strands, const GridFrame& frame, const SortedStrands& sorted,
                                 Progress& progress) {
    ExtinctionBricks bricks;
    bricks.half.resize(sorted.brick_count() * ExtinctionBricks::components * ExtinctionBricks::voxels);
    bricks.trace.resize(sorted.brick_count() * ExtinctionBricks::voxels);
    parallel_for(sorted.brick_count(), 16, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t b = begin; b < end; ++b) fill_brick(strands, frame, sorted, b, bricks);
    });
    return bricks;
}

}  // namespace hairbake
