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

/// Piece `part` of the equal pieces of segment `segment`; its centre lies in voxel `voxel` of its brick.
struct StrandPiece {
    std::uint32_t segment;
    std::uint16_t part;
    std::uint16_t voxel;
};

/// A segment in grid space, cut into `parts` equal pieces.
struct CutSegment {
    Vec3f start, step;  ///< centre of piece k = start + (k + 1/2) step
    int parts;
    Vec3f centre(int part) const { return start + (static_cast<float>(part) + 0.5f) * step; }
};

/// Cuts solid segment `segment`. Pieces are at most one voxel long; at most 65,535 of them (a segment crosses no more than 1,774
/// voxels).
inline CutSegment cut_segment(const StrandGeometry& strands, const GridFrame& frame, std::uint32_t segment) {
    const Vec3f start = frame.to_grid(strands.positions[segment]);
    const Vec3f whole = frame.to_grid(strands.positions[segment + 1]) - start;
    const int parts = std::max(1, static_cast<int>(std::ceil(length(whole))));
    return {start, whole / static_cast<float>(parts), parts};
}

/// Occupied bricks in ascending linear index, and what lies in each: brick b holds the pieces
/// [piece_begin[b], piece_begin[b+1]) and the vertices [vertex_begin[b], vertex_begin[b+1]). Pieces of a brick are sorted by voxel; what is equal is in model order.
struct SortedStrands {
    std::vector<std::uint32_t> bricks;       ///< [B] linear index of GridFrame
    std::vector<std::int32_t> slot_of_brick; ///< [frame.brick_count()] index into `bricks`, or -1
    std::vector<std::size_t> piece_begin;    ///< [B + 1]
    std::vector<StrandPiece> pieces;
    std::vector<std::uint32_t> voxel_end;    ///< [B * 512] end of a voxel's pieces, from its brick's first piece
    std::vector<std::uint32_t> vertex_begin; ///< [B + 1]
    std::vector<std::uint32_t> vertices;     ///< [V], indices of the model's points

    std::size_t brick_count() const { return bricks.size(); }

    /// Pieces in voxel `voxel` of brick number `slot`.
    std::span<const StrandPiece> pieces_in(std::size_t slot, std::size_t voxel) const {
        const std::uint32_t* end = &voxel_end[slot * 512 + voxel];
        const std::uint32_t begin = voxel == 0 ? 0 : end[-1];
        return {pieces.data() + piece_begin[slot] + begin, *end - begin};
    }
    /// Number of the brick at brick coordinates (i, j, k), or -1 where nothing is or outside the grid.
    std::int32_t slot_at(const GridFrame& frame, int i, int j, int k) const {
        if (i < 0 || j < 0 || k < 0 || i >= frame.bricks[0] || j >= frame.bricks[1] || k >= frame.bricks[2]) return -1;
        return slot_of_brick[frame.brick_of(8 * i, 8 * j, 8 * k)];
    }
};

/// Sorts by counting; the order depends on the input alone. Throws Error(out_of_resources), Error(cancelled).
SortedStrands sort_strands(const StrandGeometry& strands, const GridFrame& frame, Progress& progress);

}  // namespace hairbake
