// The extinction grid and the vertices as one sweep along a major axis meets them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/strand_pieces.h"

namespace hairbake {

/// Slices of one voxel's thickness along axis m. In a slice, u and v are the two other axes in ascending order. A tile
/// is a brick's part of a slice, 8 x 8 voxels, texel = 8 * (v & 7) + (u & 7).
///
/// Tiles of slice s: [tile_begin[s], tile_begin[s+1]). Slots are vertices sorted by slice and then by tile; the slots
/// of slice s are [slot_begin[s], slot_begin[s+1]), padded to a multiple of 16 with copies that belong to no vertex.
struct SliceLayout {
    static constexpr int tile_texels = 64;
    static constexpr std::uint32_t no_vertex = ~0u;

    struct Tile {
        std::uint16_t u, v;  ///< of its first texel
    };

    int axis = 0, axis_u = 1, axis_v = 2;
    int slices = 0, size_u = 0, size_v = 0;

    std::vector<std::uint32_t> tile_begin;  ///< [slices + 1]
    std::vector<Tile> tiles;
    std::vector<std::array<std::uint32_t, 8>> brick_tiles;  ///< [brick number][slice in it]: the tile
    std::vector<std::uint16_t> tensors;                     ///< half floats [(tile * 6 + component) * 64 + texel]

    std::vector<std::uint32_t> slot_begin;      ///< [slices + 1]
    std::vector<float> slot_u, slot_v, slot_s;  ///< vertex position in grid space along u, v and the axis
    std::vector<std::uint32_t> slot_texel;      ///< 64 * (tile - first tile of the slice) + texel
    std::vector<std::uint32_t> slot_vertex;     ///< index into SortedStrands::vertices, or no_vertex
};

SliceLayout make_slice_layout(const GridFrame& frame, const SortedStrands& sorted, const ExtinctionBricks& bricks,
                              int axis, Progress& progress);

}  // namespace hairbake
