// Strands cut into pieces of at most half a voxel, and pieces and vertices sorted by the brick they lie in.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
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

/// Cuts solid segment `segment`. Pieces are at most half a voxel long; at most 65,535 of them (a segment crosses no more than 1,774
/// voxels).
inline CutSegment cut_segment(const StrandGeometry& strands, const GridFrame& frame, std::uint32_t segment) {
    const Vec3f start = frame.to_grid(strands.positions[segment]);
    const Vec3f whole = frame.to_grid(strands.positions[segment + 1]) - start;
    const int parts = std::max(1, static_cast<int>(std::ceil(2 * length(whole))));
    return {start, whole / static_cast<float>(parts), parts};
}

/// Occupied bricks in ascending linear index, and what lies in each: brick b holds the pieces
/// [piece_begin[b], piece_begin[b+1]) and the vertices [vertex_begin[b], vertex_begin[b+1]), each in model order.
struct SortedStrands {
    std::vector<std::uint32_t> bricks;       ///< [B] linear index of GridFrame
    std::vector<std::int32_t> slot_of_brick; ///< [frame.brick_count()] index into `bricks`, or -1
    std::vector<std::size_t> piece_begin;    ///< [B + 1]
    std::vector<StrandPiece> pieces;
    std::vector<std::uint32_t> vertex_begin; ///< [B + 1]
    std::vector<std::uint32_t> vertices;     ///< [V], indices of the model's points

    std::size_t brick_count() const { return bricks.size(); }
};

/// Sorts by counting; the order depends on the input alone. Throws Error(out_of_resources), Error(cancelled).
SortedStrands sort_strands(const StrandGeometry& strands, const GridFrame& frame, Progress& progress);

}  // namespace hairbake
