#include "core/volume/slice_layout.h"

#include <cstddef>

#include "core/base/parallel.h"

namespace hairbake {
namespace {

constexpr std::uint32_t kPad = 16;

/// First voxel of brick number `slot`.
std::array<int, 3> first_voxel(const GridFrame& frame, const SortedStrands& sorted, std::size_t slot) {
    const std::array<int, 3> brick = frame.brick_coordinates(sorted.bricks[slot]);
    return {8 * brick[0], 8 * brick[1], 8 * brick[2]};
}

/// Where each brick's eight slices go.
void place_tiles(const GridFrame& frame, const SortedStrands& sorted, SliceLayout& layout) {
    std::vector<std::uint32_t> bricks_in_layer(static_cast<std::size_t>(layout.slices / 8));
    std::vector<std::array<int, 3>> first(sorted.brick_count());
    for (std::size_t b = 0; b < first.size(); ++b) {
        first[b] = first_voxel(frame, sorted, b);
        ++bricks_in_layer[static_cast<std::size_t>(first[b][static_cast<std::size_t>(layout.axis)] / 8)];
    }
    layout.tile_begin.assign(static_cast<std::size_t>(layout.slices) + 1, 0);
    for (std::size_t s = 0; s < static_cast<std::size_t>(layout.slices); ++s)
        layout.tile_begin[s + 1] = layout.tile_begin[s] + bricks_in_layer[s / 8];
    layout.tiles.resize(layout.tile_begin.back());

    std::vector<std::uint32_t> used(bricks_in_layer.size());
    auto& tile_of = layout.brick_tiles;
    tile_of.resize(sorted.brick_count());
    for (std::size_t b = 0; b < first.size(); ++b) {
        const auto layer = static_cast<std::size_t>(first[b][static_cast<std::size_t>(layout.axis)] / 8);
        const std::uint32_t place = used[layer]++;
        for (std::size_t k = 0; k < 8; ++k) {
            tile_of[b][k] = layout.tile_begin[8 * layer + k] + place;
            layout.tiles[tile_of[b][k]] = {
                static_cast<std::uint16_t>(first[b][static_cast<std::size_t>(layout.axis_u)]),
                static_cast<std::uint16_t>(first[b][static_cast<std::size_t>(layout.axis_v)])};
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

/// Number of the first slot of slice k of each brick, after the slots of the bricks before it in that slice.
std::vector<std::array<std::uint32_t, 8>> place_slots(const GridFrame& frame, const SortedStrands& sorted,
                                                      SliceLayout& layout) {
    std::vector<std::array<std::uint32_t, 8>> slots(sorted.brick_count());
    parallel_for(slots.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
            for (std::uint32_t i = sorted.vertex_begin[b]; i < sorted.vertex_begin[b + 1]; ++i)
                ++slots[b][static_cast<std::size_t>(sorted.vertex_positions[i][layout.axis]) & 7];
    });
    std::vector<std::uint32_t> count(static_cast<std::size_t>(layout.slices));
    for (std::size_t b = 0; b < slots.size(); ++b) {
        const auto layer =
            static_cast<std::size_t>(first_voxel(frame, sorted, b)[static_cast<std::size_t>(layout.axis)]);
        for (std::size_t k = 0; k < 8; ++k) {
            const std::uint32_t n = slots[b][k];
            slots[b][k] = count[layer + k];
            count[layer + k] += n;
        }
    }
    layout.slot_begin.assign(static_cast<std::size_t>(layout.slices) + 1, 0);
    for (std::size_t s = 0; s < count.size(); ++s)
        layout.slot_begin[s + 1] = layout.slot_begin[s] + (count[s] + kPad - 1) / kPad * kPad;
    for (std::size_t b = 0; b < slots.size(); ++b) {
        const auto layer =
            static_cast<std::size_t>(first_voxel(frame, sorted, b)[static_cast<std::size_t>(layout.axis)]);
        for (std::size_t k = 0; k < 8; ++k) slots[b][k] += layout.slot_begin[layer + k];
    }
    return slots;
}

void resize_slots(SliceLayout& layout) {
    const std::size_t count = layout.slot_begin.back();
    layout.slot_u.assign(count, 0);
    layout.slot_v.assign(count, 0);
    layout.slot_s.assign(count, 0);
    layout.slot_texel.assign(count, 0);
    layout.slot_vertex.assign(count, SliceLayout::no_vertex);
    for (std::size_t s = 0; s < static_cast<std::size_t>(layout.slices); ++s)  // padding reads its own slice
        for (std::uint32_t slot = layout.slot_begin[s]; slot < layout.slot_begin[s + 1]; ++slot)
            layout.slot_s[slot] = static_cast<float>(s);
}

void fill_slots(const SortedStrands& sorted, std::vector<std::array<std::uint32_t, 8>> next, SliceLayout& layout) {
    parallel_for(next.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b)
            for (std::uint32_t i = sorted.vertex_begin[b]; i < sorted.vertex_begin[b + 1]; ++i) {
                const Vec3f& g = sorted.vertex_positions[i];
                const auto s = static_cast<std::size_t>(g[layout.axis]);
                const std::uint32_t slot = next[b][s & 7]++;
                layout.slot_u[slot] = g[layout.axis_u];
                layout.slot_v[slot] = g[layout.axis_v];
                layout.slot_s[slot] = g[layout.axis];
                const auto texel = static_cast<std::uint32_t>((static_cast<int>(g[layout.axis_v]) & 7) * 8 +
                                                              (static_cast<int>(g[layout.axis_u]) & 7));
                layout.slot_texel[slot] =
                    SliceLayout::tile_texels * (layout.brick_tiles[b][s & 7] - layout.tile_begin[s]) + texel;
                layout.slot_vertex[slot] = i;
            }
    });
}

}  // namespace

SliceLayout make_slice_layout(const GridFrame& frame, const SortedStrands& sorted, const ExtinctionBricks& bricks,
                              int axis, Progress& progress) {
    SliceLayout layout;
    layout.axis = axis;
    layout.axis_u = axis == 0 ? 1 : 0;
    layout.axis_v = axis == 2 ? 1 : 2;
    layout.slices = frame.voxels(axis);
    layout.size_u = frame.voxels(layout.axis_u);
    layout.size_v = frame.voxels(layout.axis_v);
    place_tiles(frame, sorted, layout);
    copy_tensors(bricks, layout);
    progress.check();
    auto slots = place_slots(frame, sorted, layout);
    resize_slots(layout);
    fill_slots(sorted, std::move(slots), layout);
    return layout;
}

}  // namespace hairbake
