// The points of a receiving surface as one sweep along a major axis meets them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/mesh/triangle_mesh.h"
#include "core/volume/grid_frame.h"
#include "core/volume/slice_layout.h"
#include "core/volume/strand_pieces.h"

namespace hairbake {

/// Points sorted by slice, as the slots of SliceLayout are, but points may lie anywhere: those below the grid are in
/// slice -1, those above it in slice `slices`, and those beside it in their slice without a texel. So a large mesh does
/// not enlarge the grid: its points read the rays that pass them, and where no ray does, nothing is in the way. Slots
/// of slice s: [begin[s + 1], begin[s + 2]), padded to a multiple of 16 with copies that belong to no point and have no
/// normal.
struct ReceiverSlots {
    static constexpr std::uint32_t no_point = SliceLayout::no_vertex;
    static constexpr std::int32_t no_texel = -1;

    std::vector<std::uint32_t> begin;                 ///< [slices + 3]
    std::vector<float> u, v, s;                       ///< position in grid space
    std::vector<float> normal_x, normal_y, normal_z;  ///< model axes
    std::vector<std::int32_t> texel;                  ///< as SliceLayout::slot_texel, or no_texel
    std::vector<std::uint32_t> point;                 ///< index of the mesh's position, or no_point

    std::size_t slots() const { return point.size(); }
};

/// `layout` is that of the same frame, strands and axis. Throws Error(out_of_resources) for 2^31 points or more.
ReceiverSlots make_receiver_slots(const GridFrame& frame, const SortedStrands& sorted, const SliceLayout& layout,
                                  const TriangleMesh& receiver);

}  // namespace hairbake
