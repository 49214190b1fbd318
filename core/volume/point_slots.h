// The points of a set in the order in which one sweep along a major axis meets them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/hair_volume.h"
#include "core/volume/point_set.h"
#include "core/volume/slice_layout.h"

namespace hairbake {

/// Points sorted by slice; within a slice they keep the order of the set. Row r holds the points of slice r - 1: row 0
/// those below the grid, row slices + 1 those above it. Points beside the grid are in their slice and have no texel.
/// Thus a large mesh does not enlarge the grid: its points read the rays that pass them.
///
/// Row r occupies the slots [begin[r], begin[r + 1]). It is padded to a multiple of `group` with slots that belong to
/// no point, lie in the row's slice and have no vector. Arrays other than `begin` are [slots].
struct PointSlots {
    static constexpr std::uint32_t group = 16;
    static constexpr std::uint32_t no_point = ~0u;
    static constexpr std::int32_t no_texel = -1;

    std::vector<std::uint32_t> begin;                 ///< [slices + 3]
    std::vector<float> u, v, s;                       ///< position in grid space along u, v and the axis of SliceLayout
    std::vector<std::int32_t> texel;                  ///< 64 * (tile - first tile of the slice) + texel, or no_texel
    std::vector<std::uint32_t> point;                 ///< index into the point set, or no_point
    std::vector<float> vector_x, vector_y, vector_z;  ///< PointSet::vectors; empty where the set has none
    bool all_inside = false;                          ///< every point has a texel

    std::size_t size() const { return point.size(); }
};

/// `layout` must be that of `volume`. The same for any thread count.
PointSlots make_point_slots(const HairVolume& volume, const SliceLayout& layout, const PointSet& points);

}  // namespace hairbake
