#include "core/volume/direction_sweep.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "core/base/parallel.h"
#include "core/volume/point_slots.h"
#include "core/volume/slice_layout.h"
#include "core/volume/sweep.h"

namespace hairbake {
namespace {

using DirectionGroup = std::vector<std::uint32_t>;  ///< indices into the direction set

int major_axis(const Vec3d& l) {
    const double x = std::abs(l.x), y = std::abs(l.y), z = std::abs(l.z);
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/// The directions with this major axis in groups with one sign, of nearly equal size and at most kSweepLanes.
std::vector<DirectionGroup> group_directions(std::span<const Vec3d> directions, int axis) {
    std::vector<DirectionGroup> groups;
    for (const double sign : {1.0, -1.0}) {
        DirectionGroup side;
        for (std::uint32_t k = 0; k < directions.size(); ++k)
            if (major_axis(directions[k]) == axis && directions[k][axis] * sign > 0) side.push_back(k);
        const std::size_t count = (side.size() + kSweepLanes - 1) / kSweepLanes;
        for (std::size_t g = 0; g < count; ++g)
            groups.emplace_back(side.begin() + static_cast<std::ptrdiff_t>(g * side.size() / count),
                                side.begin() + static_cast<std::ptrdiff_t>((g + 1) * side.size() / count));
    }
    return groups;
}

/// A point set and the readers that share it.
struct ReadSet {
    const PointSet* points;
    std::vector<const SweepReader*> readers;
    std::vector<std::size_t> places;  ///< of the readers, in the caller's order
};

std::vector<ReadSet> group_readers(std::span<const SweepReader* const> readers) {
    std::vector<ReadSet> sets;
    for (std::size_t r = 0; r < readers.size(); ++r) {
        const PointSet* points = &readers[r]->points();
        auto set = std::find_if(sets.begin(), sets.end(), [&](const ReadSet& s) { return s.points == points; });
        if (set == sets.end()) set = sets.insert(sets.end(), {points, {}, {}});
        set->readers.push_back(readers[r]);
        set->places.push_back(r);
    }
    return sets;
}

/// The most walks along one axis that run at the same time, on any machine. Each thread has sums of its own, 4 bytes
/// for each point and component. With many components fewer walks run, so that the sums take at most 512 bytes a point.
std::size_t most_walks(std::span<const ReadSet> sets) {
    std::size_t components = 1;
    for (const ReadSet& set : sets) {
        std::size_t of_set = 0;
        for (const SweepReader* reader : set.readers) of_set += reader->scales().size();
        components = std::max(components, of_set);
    }
    return std::clamp<std::size_t>(128 / components, 1, 16);
}

/// The occluder's shadow on the slots of a point set.
struct SlotShadow {
    const PointShadow& shadow;
    OccluderShadow::Points points;

    SlotShadow(const PointSet& set, const PointSlots& slots) : shadow(*set.shadow) {
        std::vector<std::uint32_t> model(slots.point);
        for (std::uint32_t& point : model)
            if (point != PointSlots::no_point && !set.model_index.empty()) point = set.model_index[point];
        points = shadow.points(model);
    }
};

/// One axis: the grid in slices, and the slots of each point set.
struct Axis {
    struct Set {
        const ReadSet& read;
        PointSlots slots;
        std::optional<SlotShadow> shadow;
    };
    SliceLayout layout;
    std::vector<Set> sets;

    Axis(const HairVolume& volume, int axis, std::span<const ReadSet> read_sets, const Progress& progress)
        : layout(make_slice_layout(volume, axis, progress)) {
        for (const ReadSet& read : read_sets) {
            Set& set = sets.emplace_back(Set{read, make_point_slots(volume, layout, *read.points), {}});
            progress.check();
            if (read.points->shadow) set.shadow.emplace(*read.points, set.slots);
        }
    }
};

/// Sums and buffers of one thread for all its walks along an axis.
struct Worker {
    std::vector<std::vector<SweepSums>> sums;     ///< [set][reader]
    std::vector<std::vector<std::uint8_t>> seen;  ///< [set], SweepStop::seen
    SweepScratch sweep;
    OccluderShadow::Scratch raster;

    explicit Worker(const Axis& axis) : seen(axis.sets.size()) {
        for (const Axis::Set& set : axis.sets) {
            auto& of_set = sums.emplace_back();
            for (const SweepReader* reader : set.read.readers)
                of_set.emplace_back(set.slots.size(), reader->scales().size());
        }
    }
};

void sweep_group(const Axis& axis, std::span<const Vec3d> directions, const DirectionGroup& group,
                 const Progress& progress, Worker& worker) {
    std::vector<Vec3d> lights;
    for (const std::uint32_t k : group) lights.push_back(directions[k]);
    std::vector<SweepStop> stops;
    for (std::size_t i = 0; i < axis.sets.size(); ++i) {
        const Axis::Set& set = axis.sets[i];
        if (set.shadow)
            set.shadow->shadow.occluder().visible(set.shadow->points, lights, progress, worker.raster, worker.seen[i]);
        stops.push_back({set.slots, worker.seen[i], set.read.readers, worker.sums[i]});
    }
    sweep(axis.layout, directions, group, stops, worker.sweep);
}

/// Sweeps all groups of one axis and adds their sums to `sums`. Calls swept(n) after every n directions.
void sweep_axis(const Axis& axis, std::span<const Vec3d> directions, std::span<const DirectionGroup> groups,
                std::size_t walks, const Progress& progress, const std::function<void(std::size_t)>& swept,
                std::vector<FixedPointSums>& sums) {
    walks = std::min(groups.size(), walks);
    std::vector<std::vector<SweepSums>> parts(sums.size(), std::vector<SweepSums>(walks));  // [reader][walk]
    std::atomic<std::size_t> next{0};
    parallel_for(walks, 1, [&](std::size_t w, std::size_t) {
        std::optional<Worker> worker;  // only where there is a group left
        for (std::size_t g = next++; g < groups.size(); g = next++) {
            progress.check();
            if (!worker) worker.emplace(axis);
            sweep_group(axis, directions, groups[g], progress, *worker);
            swept(groups[g].size());
        }
        for (std::size_t i = 0; worker && i < axis.sets.size(); ++i)
            for (std::size_t r = 0; r < worker->sums[i].size(); ++r)
                parts[axis.sets[i].read.places[r]][w] = std::move(worker->sums[i][r]);
    });
    for (const Axis::Set& set : axis.sets)
        for (const std::size_t place : set.read.places) sums[place].add(set.slots.point, parts[place]);
}

}  // namespace

std::vector<FixedPointSums> sweep_directions(const HairVolume& volume, std::span<const Vec3d> directions,
                                             std::span<const SweepReader* const> readers, Progress& progress) {
    const std::vector<ReadSet> sets = group_readers(readers);
    std::vector<FixedPointSums> sums;
    for (const SweepReader* reader : readers) sums.emplace_back(reader->points().size(), reader->scales());
    std::atomic<std::size_t> done{0};
    const auto swept = [&](std::size_t n) {
        progress.report(static_cast<double>(done += n) / static_cast<double>(directions.size()));
    };
    for (int a = 0; a < 3; ++a) {
        const auto groups = group_directions(directions, a);
        if (groups.empty()) continue;
        const Axis axis(volume, a, sets, progress);
        sweep_axis(axis, directions, groups, most_walks(sets), progress, swept, sums);
    }
    return sums;
}

}  // namespace hairbake
