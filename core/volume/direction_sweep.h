// Sweeps all directions, axis by axis, and sums up what every vertex and every point of the receiver gets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/triangle_mesh.h"
#include "core/visibility/direction_moments.h"
#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/point_shadow.h"
#include "core/volume/strand_pieces.h"
#include "core/volume/sweep.h"

namespace hairbake {

/// Sums over all directions by item (vertex in the order of SortedStrands, or position of the receiver), as integers of
/// the sweep's scale.
class ItemSums {
public:
    ItemSums(std::size_t items, std::size_t components, float scale)
        : components_(components), scale_(scale), values_(items * components) {}

    /// Adds slots to items: item_of_slot[i] is the item of slot i, or SliceLayout::no_vertex.
    void add(std::span<const std::uint32_t> item_of_slot, std::span<const SweepTotals> parts,
             SweepSums SweepTotals::*kind);

    std::size_t items() const { return components_ == 0 ? 0 : values_.size() / components_; }
    float scale() const { return scale_; }
    /// [components] of one item; sum = integer / scale().
    std::span<const std::int32_t> of(std::size_t item) const {
        return {values_.data() + item * components_, components_};
    }

private:
    std::size_t components_;
    float scale_;
    std::vector<std::int32_t> values_;  ///< [item * components + component]
};

struct DirectionSums {
    ItemSums vertices;   ///< the components are the moments
    ItemSums receivers;  ///< the components are those of HemisphereSums
};

/// What is asked of a sweep.
struct SweepRequest {
    std::span<const Vec3d> directions;
    const DirectionMoments& moments;         ///< of the directions; at least four
    const TriangleMesh* receiver = nullptr;  ///< whose positions are read
    /// Shadows of an occluder on the model's vertices and on the receiver's positions; null for none.
    const PointShadow *vertex_shadow = nullptr, *receiver_shadow = nullptr;
};

/// Sweeps `bricks` in every direction. Throws Error(out_of_resources),
/// Error(cancelled).
DirectionSums sweep_directions(const GridFrame& frame, const SortedStrands& sorted, const ExtinctionBricks& bricks,
                               const SweepRequest& request, Progress& progress);

}  // namespace hairbake
