#include "core/volume/slice_layout.h"

#include <cstddef>

#include "core/base/assert.h"
#include "core/base/parallel.h"

namespace hairbake {
namespace {

/// First voxel of every brick.
std::vector<std::array<int, 3>> first_voxels(const HairVolume& volume) {
    std::vector<std::array<int, 3>> first;
    first.reserve(volume.sorted.brick_count());
    for (const std::uint32_t brick : volume.sorted.bricks) {
        const std::array<int, 3> place = volume.frame.brick_coordinates(brick);
        first.push_back({8 * place[0], 8 * place[1], 8 * place[2]});
    }
    return first;
}

/// Numbers the tiles of each brick's eight slices.
void place_tiles(const HairVolume& volume, SliceLayout& layout) {
    const auto first = first_voxels(volume);
    const auto axis = static_cast<std::size_t>(layout.axis);
    std::vector<std::uint32_t> bricks_in_layer(static_cast<std::size_t>(layout.slices / 8));
    for (const auto& voxel : first) ++bricks_in_layer[static_cast<std::size_t>(voxel[axis] / 8)];
    layout.tile_begin.assign(static_cast<std::size_t>(layout.slices) + 1, 0);
    for (std::size_t s = 0; s < static_cast<std::size_t>(layout.slices); ++s)
        layout.tile_begin[s + 1] = layout.tile_begin[s] + bricks_in_layer[s / 8];
    layout.tiles.resize(layout.tile_begin.back());

    std::vector<std::uint32_t> used(bricks_in_layer.size());
    layout.brick_tiles.resize(first.size());
    for (std::size_t b = 0; b < first.size(); ++b) {
        const auto layer = static_cast<std::size_t>(first[b][axis] / 8);
        const std::uint32_t place = used[layer]++;
        const SliceLayout::Tile tile{static_cast<std::uint16_t>(first[b][static_cast<std::size_t>(layout.axis_u)]),
                                     static_cast<std::uint16_t>(first[b][static_cast<std::size_t>(layout.axis_v)])};
        for (std::size_t k = 0; k < 8; ++k) {
            layout.brick_tiles[b][k] = layout.tile_begin[8 * layer + k] + place;
            layout.tiles[layout.brick_tiles[b][k]] = tile;
        }
    }
}

/// Strides of the voxel index inside a brick along the model's axes.
constexpr std::array<std::size_t, 3> kStride{64, 8, 1};

void copy_tensors(const ExtinctionBricks& bricks, SliceLayout& layout) {
    const auto& tile_of = layout.brick_tiles;
    const std::size_t stride_s = kStride[static_cast<std::size_t>(layout.axis)];
    const std::size_t stride_u = kStride[static_cast<std::size_t>(layout.axis_u)];
    const std::size_t stride_v = kStride[static_cast<std::size_t>(layout.axis_v)];
    layout.tensors.resize(layout.tiles.size() * ExtinctionBricks::components * SliceLayout::tile_texels);
    parallel_for(tile_of.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
            for (std::size_t k = 0; k < 8; ++k)
                for (int c = 0; c < ExtinctionBricks::components; ++c) {
                    const std::uint16_t* from = bricks.component(b, c) + k * stride_s;
                    std::uint16_t* to = &layout.tensors[(tile_of[b][k] * std::size_t{ExtinctionBricks::components} +
                                                         static_cast<std::size_t>(c)) *
                                                        SliceLayout::tile_texels];
                    for (std::size_t v = 0; v < 8; ++v)
                        for (std::size_t u = 0; u < 8; ++u) to[8 * v + u] = from[v * stride_v + u * stride_u];
                }
    });
}

}  // namespace

SliceLayout make_slice_layout(const HairVolume& volume, int axis, const Progress& progress) {
    HAIRBAKE_ASSERT(axis >= 0 && axis < 3);
    SliceLayout layout;
    layout.axis = axis;
    layout.axis_u = axis == 0 ? 1 : 0;
    layout.axis_v = axis == 2 ? 1 : 2;
    layout.slices = volume.frame.voxels(axis);
    layout.size_u = volume.frame.voxels(layout.axis_u);
    layout.size_v = volume.frame.voxels(layout.axis_v);
    place_tiles(volume, layout);
    copy_tensors(volume.bricks, layout);
    progress.check();
    return layout;
}

}  // namespace hairbake
