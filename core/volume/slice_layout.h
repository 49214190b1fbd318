// The extinction grid as one sweep along a major axis meets it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/volume/hair_volume.h"

namespace hairbake {

/// Slices of one voxel's thickness along `axis`. In a slice, u and v are the two other axes in ascending order. A tile
/// is a brick's part of a slice, 8 x 8 voxels; texel = 8 * (v & 7) + (u & 7). Slice s holds the tiles
/// [tile_begin[s], tile_begin[s + 1]).
struct SliceLayout {
    static constexpr int tile_texels = 64;

    struct Tile {
        std::uint16_t u, v;  ///< voxel coordinates of its first texel
    };

    int axis = 0, axis_u = 1, axis_v = 2;
    int slices = 0, size_u = 0, size_v = 0;  ///< voxels

    std::vector<std::uint32_t> tile_begin;  ///< [slices + 1]
    std::vector<Tile> tiles;
    std::vector<std::array<std::uint32_t, 8>> brick_tiles;  ///< [brick number][slice of the brick]: index into `tiles`
    std::vector<std::uint16_t> tensors;  ///< bits of half floats [(tile * 6 + component) * 64 + texel]
};

/// `axis`: 0, 1 or 2.
/// Throws Error(cancelled).
SliceLayout make_slice_layout(const HairVolume& volume, int axis, const Progress& progress);

}  // namespace hairbake
