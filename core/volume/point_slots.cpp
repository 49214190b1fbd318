#include "core/volume/point_slots.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <utility>

#include "core/base/assert.h"
#include "core/base/parallel.h"

namespace hairbake {
namespace {

/// The points are walked in this many chunks for any thread count; each chunk counts and then writes by itself.
constexpr std::size_t kChunks = 16;

using RowCounts = std::vector<std::uint32_t>;  ///< [row]

/// Runs body(chunk, begin, end) for the chunks of `count` points.
template <class Body>
void for_each_chunk(std::size_t count, const Body& body) {
    const std::size_t grain = std::max<std::size_t>(1, (count + kChunks - 1) / kChunks);
    parallel_for(count, grain, [&](std::size_t begin, std::size_t end) { body(begin / grain, begin, end); });
}

/// Row of position s along the axis. A position that is not a number is in row 0: nothing is in its way.
std::size_t row_of(const SliceLayout& layout, float s) {
    if (!(s >= 0)) return 0;
    return static_cast<std::size_t>(s < static_cast<float>(layout.slices) ? static_cast<int>(s) + 1
                                                                          : layout.slices + 1);
}

std::int32_t texel_of(const HairVolume& volume, const SliceLayout& layout, const Vec3f& g) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(g[axis] >= 0 && g[axis] < static_cast<float>(volume.frame.voxels(axis)))) return PointSlots::no_texel;
    const std::array<int, 3> voxel{static_cast<int>(g.x), static_cast<int>(g.y), static_cast<int>(g.z)};
    const std::int32_t brick = volume.sorted.slot_of_brick[volume.frame.brick_of(voxel[0], voxel[1], voxel[2])];
    if (brick < 0) return PointSlots::no_texel;
    const auto at = [&](int axis) { return voxel[static_cast<std::size_t>(axis)]; };
    const auto s = static_cast<std::size_t>(at(layout.axis));
    const std::uint32_t tile = layout.brick_tiles[static_cast<std::size_t>(brick)][s & 7] - layout.tile_begin[s];
    return static_cast<std::int32_t>(tile) * SliceLayout::tile_texels + (at(layout.axis_v) & 7) * 8 +
           (at(layout.axis_u) & 7);
}

/// Number of points of each chunk in each row.
std::array<RowCounts, kChunks> count_rows(const SliceLayout& layout, const PointSet& points) {
    std::array<RowCounts, kChunks> counts;
    for (RowCounts& chunk : counts) chunk.assign(static_cast<std::size_t>(layout.slices) + 2, 0);
    for_each_chunk(points.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++counts[chunk][row_of(layout, points.positions[i][layout.axis])];
    });
    return counts;
}

/// Sets slots.begin, and turns each count into the slot where the chunk writes its first point of the row.
void place_rows(std::array<RowCounts, kChunks>& counts, PointSlots& slots) {
    slots.begin.assign(counts[0].size() + 1, 0);
    for (std::size_t row = 0; row < counts[0].size(); ++row) {
        std::uint32_t next = slots.begin[row];
        for (RowCounts& chunk : counts) next += std::exchange(chunk[row], next);
        slots.begin[row + 1] = (next + PointSlots::group - 1) / PointSlots::group * PointSlots::group;
    }
}

/// Makes every slot a padding slot.
void resize(const PointSet& points, PointSlots& slots) {
    const std::size_t count = slots.begin.back();
    for (auto* array : {&slots.u, &slots.v, &slots.s}) array->assign(count, 0);
    slots.texel.assign(count, 0);
    slots.point.assign(count, PointSlots::no_point);
    for (std::size_t row = 0; row + 1 < slots.begin.size(); ++row)
        std::fill(slots.s.begin() + slots.begin[row], slots.s.begin() + slots.begin[row + 1],
                  static_cast<float>(row) - 1);
    if (points.vectors.empty()) return;
    for (auto* array : {&slots.vector_x, &slots.vector_y, &slots.vector_z}) array->assign(count, 0);
}

void fill(const HairVolume& volume, const SliceLayout& layout, const PointSet& points,
          std::array<RowCounts, kChunks>& next, PointSlots& slots) {
    std::atomic<bool> all_inside{true};
    for_each_chunk(points.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
        bool inside = true;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3f& g = points.positions[i];
            const std::uint32_t slot = next[chunk][row_of(layout, g[layout.axis])]++;
            slots.u[slot] = g[layout.axis_u];
            slots.v[slot] = g[layout.axis_v];
            slots.s[slot] = g[layout.axis];
            slots.texel[slot] = texel_of(volume, layout, g);
            slots.point[slot] = static_cast<std::uint32_t>(i);
            inside = inside && slots.texel[slot] != PointSlots::no_texel;
            if (points.vectors.empty()) continue;
            slots.vector_x[slot] = points.vectors[i].x;
            slots.vector_y[slot] = points.vectors[i].y;
            slots.vector_z[slot] = points.vectors[i].z;
        }
        if (!inside) all_inside = false;
    });
    slots.all_inside = all_inside;
}

}  // namespace

PointSlots make_point_slots(const HairVolume& volume, const SliceLayout& layout, const PointSet& points) {
    HAIRBAKE_ASSERT(points.size() < std::size_t{1} << 31);
    HAIRBAKE_ASSERT(points.vectors.empty() || points.vectors.size() == points.size());
    HAIRBAKE_ASSERT(points.model_index.empty() || points.model_index.size() == points.size());
    PointSlots slots;
    auto counts = count_rows(layout, points);
    place_rows(counts, slots);
    resize(points, slots);
    fill(volume, layout, points, counts, slots);
    return slots;
}

}  // namespace hairbake
