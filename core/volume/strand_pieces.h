// Strands cut into pieces of at most one voxel, and pieces and vertices sorted by the brick they lie in.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"
#include "core/volume/grid_frame.h"

namespace hairbake {

/// A straight piece of a strand in grid space. It counts in the voxel of its middle.
struct StrandPiece {
    Vec3f centre;
    Vec3f step;             ///< from its root end to its tip end, at most one voxel long
    float weight;           ///< opacity * width / h, means over the segment
    std::uint32_t segment;  ///< of the model, which owns the piece

    int voxel_in_brick() const {
        return GridFrame::voxel_in_brick(static_cast<int>(centre.x), static_cast<int>(centre.y),
                                         static_cast<int>(centre.z));
    }
};

/// Occupied bricks in ascending linear index. Brick number b holds the pieces [piece_begin[b], piece_begin[b + 1]),
/// sorted by voxel, and the vertices [vertex_begin[b], vertex_begin[b + 1]). Pieces of one voxel and vertices of one
/// brick keep the model's order.
struct SortedStrands {
    std::vector<std::uint32_t> bricks;        ///< [B] linear index of GridFrame
    std::vector<std::int32_t> slot_of_brick;  ///< [frame.brick_count()] index into `bricks`, or -1
    std::vector<std::uint32_t> piece_begin;   ///< [B + 1]
    std::vector<StrandPiece> pieces;
    std::vector<std::uint32_t> voxel_end;     ///< [B * 512] end of a voxel's pieces, index into `pieces`
    std::vector<std::uint32_t> vertex_begin;  ///< [B + 1]
    std::vector<std::uint32_t> vertices;      ///< [V], indices of the model's points
    std::vector<Vec3f> vertex_positions;      ///< [V], of `vertices`, grid space

    std::size_t brick_count() const { return bricks.size(); }

    /// Pieces in voxel `voxel` of brick number `slot`.
    std::span<const StrandPiece> pieces_in(std::size_t slot, std::size_t voxel) const {
        const std::uint32_t* end = &voxel_end[slot * 512 + voxel];
        const std::uint32_t begin = voxel == 0 ? piece_begin[slot] : end[-1];
        return {pieces.data() + begin, *end - begin};
    }
    /// Number of the brick at brick coordinates (i, j, k); -1 for an empty brick and outside the grid.
    std::int32_t slot_at(const GridFrame& frame, int i, int j, int k) const {
        if (i < 0 || j < 0 || k < 0 || i >= frame.bricks[0] || j >= frame.bricks[1] || k >= frame.bricks[2]) return -1;
        return slot_of_brick[frame.brick_of(8 * i, 8 * j, 8 * k)];
    }
};

/// Cuts the solid segments with an opacity above 0 and sorts by counting. The same for any thread count. `strands` must
/// have a vertex and lie within `frame`.
/// Throws Error(out_of_resources) for 2^32 pieces or more.
/// Throws Error(cancelled).
SortedStrands sort_strands(const StrandGeometry& strands, const GridFrame& frame, Progress& progress);

}  // namespace hairbake
