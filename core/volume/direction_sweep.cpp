#include "core/volume/direction_sweep.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "core/base/parallel.h"
#include "core/volume/receiver_slots.h"
#include "core/volume/slice_layout.h"

namespace hairbake {
namespace {

/// Walks along one axis that run at the same time at most, whatever the machine: each thread has sums of its own, 4
/// bytes a vertex and component. With many components fewer walks run, so that the sums take no more than 512 bytes a
/// vertex.
std::size_t most_walks(std::size_t components) { return std::min<std::size_t>(16, 128 / components); }

int major_axis(const Vec3d& l) {
    const double x = std::abs(l.x), y = std::abs(l.y), z = std::abs(l.z);
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/// Directions with one major axis and sign, in groups of nearly equal size of at most kSweepLanes.
std::vector<std::vector<SweepDirection>> group_directions(const SweepRequest& request, int axis) {
    std::vector<std::vector<SweepDirection>> groups;
    for (const double sign : {1.0, -1.0}) {
        std::vector<SweepDirection> side;
        for (std::size_t k = 0; k < request.directions.size(); ++k) {
            const Vec3d& l = request.directions[k];
            if (major_axis(l) == axis && l[axis] * sign > 0) side.push_back({l, request.moments.weights(k)});
        }
        const std::size_t count = (side.size() + kSweepLanes - 1) / kSweepLanes;
        for (std::size_t g = 0; g < count; ++g)
            groups.emplace_back(side.begin() + static_cast<std::ptrdiff_t>(g * side.size() / count),
                                side.begin() + static_cast<std::ptrdiff_t>((g + 1) * side.size() / count));
    }
    return groups;
}

/// Points that a sweep reads, and the occluder's shadow on them.
struct Shadowed {
    const PointShadow& shadow;
    OccluderShadow::Points points;

    Shadowed(const PointShadow& s, std::span<const std::uint32_t> point_of_slot)
        : shadow(s), points(s.points(point_of_slot)) {}
    void look(std::span<const Vec3d> directions, const Progress& progress, OccluderShadow::Scratch& scratch,
              std::vector<std::uint8_t>& seen) const {
        shadow.occluder().look(points, directions, progress, scratch, seen);
    }
};

/// [slot] the model's vertex, or SliceLayout::no_vertex.
std::vector<std::uint32_t> vertices_of_slots(const SliceLayout& layout, const SortedStrands& sorted) {
    std::vector<std::uint32_t> vertices(layout.slot_vertex);
    for (std::uint32_t& v : vertices)
        if (v != SliceLayout::no_vertex) v = sorted.vertices[v];
    return vertices;
}

/// One axis: the grid in slices, and who reads there.
struct Axis {
    SliceLayout layout;
    std::optional<ReceiverSlots> receivers;
    std::optional<Shadowed> vertex_shadow, receiver_shadow;

    Axis(SliceLayout l, const GridFrame& frame, const SortedStrands& sorted, const SweepRequest& request)
        : layout(std::move(l)) {
        if (request.vertex_shadow) vertex_shadow.emplace(*request.vertex_shadow, vertices_of_slots(layout, sorted));
        if (!request.receiver) return;
        receivers = make_receiver_slots(frame, sorted, layout, *request.receiver);
        if (request.receiver_shadow) receiver_shadow.emplace(*request.receiver_shadow, receivers->point);
    }
    SweepTotals empty_totals(std::size_t moments) const {
        SweepTotals totals;
        totals.vertices = SweepSums(layout.slot_vertex.size(), moments);
        if (receivers) totals.receivers = SweepSums(receivers->slots(), SweepTotals::receiver_components);
        return totals;
    }
};

/// What one thread needs; reused from walk to walk.
struct WalkScratch {
    SweepScratch sweep;
    OccluderShadow::Scratch raster;
    std::vector<std::uint8_t> vertices_see, receivers_see;
};

void sweep_group(const Axis& axis, std::span<const SweepDirection> group, float scale, const Progress& progress,
                 WalkScratch& scratch, SweepTotals& totals) {
    std::vector<Vec3d> directions;
    for (const SweepDirection& direction : group) directions.push_back(direction.l);
    if (axis.vertex_shadow) axis.vertex_shadow->look(directions, progress, scratch.raster, scratch.vertices_see);
    if (axis.receiver_shadow) axis.receiver_shadow->look(directions, progress, scratch.raster, scratch.receivers_see);
    sweep(axis.layout, axis.receivers ? &*axis.receivers : nullptr, group, scale,
          {scratch.vertices_see, scratch.receivers_see}, scratch.sweep, totals);
}

/// Sweeps all groups of one axis and adds what they bring. `swept` is told how many directions are done.
void sweep_axis(const Axis& axis, std::size_t moments, std::span<const std::vector<SweepDirection>> groups,
                const Progress& progress, const std::function<void(std::size_t)>& swept, DirectionSums& sums) {
    const std::size_t walks = std::min(groups.size(), most_walks(moments));
    std::vector<SweepTotals> totals(walks);
    std::atomic<std::size_t> next{0};
    parallel_for(walks, 1, [&](std::size_t w, std::size_t) {
        WalkScratch scratch;
        bool first = true;
        for (std::size_t g = next++; g < groups.size(); g = next++) {
            progress.check();
            if (std::exchange(first, false)) totals[w] = axis.empty_totals(moments);
            sweep_group(axis, groups[g], sums.vertices.scale(), progress, scratch, totals[w]);
            swept(groups[g].size());
        }
    });
    sums.vertices.add(axis.layout.slot_vertex, totals, &SweepTotals::vertices);
    if (axis.receivers) sums.receivers.add(axis.receivers->point, totals, &SweepTotals::receivers);
}

}  // namespace

void ItemSums::add(std::span<const std::uint32_t> item_of_slot, std::span<const SweepTotals> parts,
                   SweepSums SweepTotals::*kind) {
    parallel_for(item_of_slot.size(), 1 << 15, [&](std::size_t begin, std::size_t end) {
        for (const SweepTotals& totals : parts) {
            const SweepSums& part = totals.*kind;
            for (std::size_t i = begin; i < end && part.slots > 0; ++i) {
                if (item_of_slot[i] == SliceLayout::no_vertex) continue;
                std::int32_t* sum = &values_[std::size_t{item_of_slot[i]} * components_];
                for (std::size_t c = 0; c < components_; ++c) sum[c] += part.values[c * part.slots + i];
            }
        }
    });
}

DirectionSums sweep_directions(const GridFrame& frame, const SortedStrands& sorted, const ExtinctionBricks& bricks,
                               const SweepRequest& request, Progress& progress) {
    const std::size_t count = request.directions.size();
    const float scale = sweep_scale(static_cast<int>(count));
    const std::size_t points = request.receiver ? request.receiver->positions.size() : 0;
    DirectionSums sums{ItemSums(sorted.vertices.size(), request.moments.count(), scale),
                       ItemSums(points, SweepTotals::receiver_components, scale)};
    std::atomic<std::size_t> done{0};
    for (int a = 0; a < 3; ++a) {
        const auto groups = group_directions(request, a);
        if (groups.empty()) continue;
        const Axis axis(make_slice_layout(frame, sorted, bricks, a, progress), frame, sorted, request);
        const auto swept = [&](std::size_t n) {
            progress.report(static_cast<double>(done += n) / static_cast<double>(count));
        };
        sweep_axis(axis, request.moments.count(), groups, progress, swept, sums);
    }
    return sums;
}

}  // namespace hairbake
