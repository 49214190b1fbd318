#include "core/volume/receiver_slots.h"

#include <algorithm>
#include <string>

#include "core/base/error.h"

namespace hairbake {
namespace {

constexpr std::uint32_t kPad = 16;

/// -1 below the grid, `slices` above it. What is no number is far away, too.
int slice_of(const SliceLayout& layout, float s) {
    return s >= 0 ? (s < static_cast<float>(layout.slices) ? static_cast<int>(s) : layout.slices) : -1;
}

std::int32_t texel_of(const GridFrame& frame, const SortedStrands& sorted, const SliceLayout& layout, const Vec3f& g) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(g[axis] >= 0 && g[axis] < static_cast<float>(frame.voxels(axis)))) return ReceiverSlots::no_texel;
    const std::array<int, 3> voxel{static_cast<int>(g.x), static_cast<int>(g.y), static_cast<int>(g.z)};
    const std::int32_t brick = sorted.slot_at(frame, voxel[0] / 8, voxel[1] / 8, voxel[2] / 8);
    if (brick < 0) return ReceiverSlots::no_texel;
    const auto at = [&](int axis) { return voxel[static_cast<std::size_t>(axis)]; };
    const auto s = static_cast<std::size_t>(at(layout.axis));
    const std::uint32_t tile = layout.brick_tiles[static_cast<std::size_t>(brick)][s & 7] - layout.tile_begin[s];
    return static_cast<std::int32_t>(tile) * SliceLayout::tile_texels + (at(layout.axis_v) & 7) * 8 +
           (at(layout.axis_u) & 7);
}

void resize(ReceiverSlots& slots, std::size_t count) {
    for (auto* array : {&slots.u, &slots.v, &slots.s, &slots.normal_x, &slots.normal_y, &slots.normal_z})
        array->assign(count, 0);
    slots.texel.assign(count, ReceiverSlots::no_texel);
    slots.point.assign(count, ReceiverSlots::no_point);
}

}  // namespace

ReceiverSlots make_receiver_slots(const GridFrame& frame, const SortedStrands& sorted, const SliceLayout& layout,
                                  const TriangleMesh& receiver) {
    const std::size_t count = receiver.positions.size();
    if (count >> 31)
        throw Error(ErrorKind::out_of_resources,
                    "the receiver has " + std::to_string(count) + " positions; fewer than 2147483648 are allowed",
                    "receiver");
    ReceiverSlots slots;
    std::vector<std::uint32_t> next(static_cast<std::size_t>(layout.slices) + 2);
    const auto row_of = [&](const Vec3f& g) { return static_cast<std::size_t>(slice_of(layout, g[layout.axis]) + 1); };
    for (const Vec3f& p : receiver.positions) ++next[row_of(frame.to_grid(p))];
    slots.begin.push_back(0);
    for (std::uint32_t& n : next) {
        const std::uint32_t first = slots.begin.back();
        slots.begin.push_back(first + (n + kPad - 1) / kPad * kPad);
        n = first;
    }
    resize(slots, slots.begin.back());
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3f g = frame.to_grid(receiver.positions[i]), n = receiver.normals[i];
        const std::uint32_t slot = next[row_of(g)]++;
        slots.u[slot] = g[layout.axis_u];
        slots.v[slot] = g[layout.axis_v];
        slots.s[slot] = g[layout.axis];
        slots.normal_x[slot] = n.x;
        slots.normal_y[slot] = n.y;
        slots.normal_z[slot] = n.z;
        slots.texel[slot] = texel_of(frame, sorted, layout, g);
        slots.point[slot] = static_cast<std::uint32_t>(i);
    }
    return slots;
}

}  // namespace hairbake
