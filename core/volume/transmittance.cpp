#include "core/volume/transmittance.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/base/parallel.h"
#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/slice_layout.h"
#include "core/volume/strand_pieces.h"
#include "core/volume/sweep.h"
#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace hairbake {
namespace {
struct Clock { std::chrono::steady_clock::time_point t = std::chrono::steady_clock::now(); void lap(const char* n){ auto u=std::chrono::steady_clock::now(); if(getenv("HB_T")) std::fprintf(stderr,"%-10s %.3f\n",n,std::chrono::duration<double>(u-t).count()); t=u; } };

int major_axis(const Vec3d& l) {
    const double x = std::abs(l.x), y = std::abs(l.y), z = std::abs(l.z);
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/// Directions with one major axis and sign, in groups of nearly equal size of at most kSweepLanes.
std::vector<std::vector<Vec3d>> group_directions(std::span<const Vec3d> directions, int axis) {
    std::vector<std::vector<Vec3d>> groups;
    for (const double sign : {1.0, -1.0}) {
        std::vector<Vec3d> side;
        for (const Vec3d& l : directions)
            if (major_axis(l) == axis && l[axis] * sign > 0) side.push_back(l);
        const std::size_t count = (side.size() + kSweepLanes - 1) / kSweepLanes;
        for (std::size_t g = 0; g < count; ++g)
            groups.emplace_back(side.begin() + static_cast<std::ptrdiff_t>(g * side.size() / count),
                                side.begin() + static_cast<std::ptrdiff_t>((g + 1) * side.size() / count));
    }
    return groups;
}

struct Worker { SweepScratch scratch; std::unique_ptr<SweepSums> sums; };

}  // namespace

Transmittance bake_transmittance_volume(const StrandGeometry& strands, const TransmittanceSettings& settings,
                                        Progress& progress) {
    Transmittance result;
    const auto directions = make_directions(settings.direction_set, settings.directions, settings.seed);
    result.directions = settings.directions;
    bool bounded = false;
    Clock clock;
    const GridFrame frame = make_grid_frame(strands, settings, &bounded);
    result.voxel_size = frame.voxel_size;
    const SortedStrands sorted = sort_strands(strands, frame, progress);
    clock.lap("sort");
    const ExtinctionBricks bricks = deposit_strands(strands, frame, sorted, progress);
    clock.lap("deposit");
    const float scale = sweep_scale(settings.directions);
    std::vector<std::int32_t> total(strands.vertex_count() * SweepSums::components);
    for (int axis = 0; axis < 3; ++axis) {
        const auto groups = group_directions(directions, axis);
        const SliceLayout layout = make_slice_layout(strands, frame, sorted, bricks, axis, progress);
        clock.lap("layout");
        std::vector<Worker> workers(static_cast<std::size_t>(thread_count()));
        parallel_for(groups.size(), 1, [&](std::size_t begin, std::size_t) {
            progress.check();
            Worker& worker = workers[static_cast<std::size_t>(thread_index())];
            if (!worker.sums) worker.sums = std::make_unique<SweepSums>(layout.slot_vertex.size());
            sweep(layout, groups[begin], scale, worker.scratch, *worker.sums);
        });
        clock.lap("sweep");
        parallel_for(layout.slot_vertex.size(), 65536, [&](std::size_t begin, std::size_t end) {
            for (const Worker& worker : workers)
                if (worker.sums)
                    for (std::size_t i = begin; i < end; ++i) {
                        const std::uint32_t v = layout.slot_vertex[i];
                        if (v == SliceLayout::no_vertex) continue;
                        for (std::size_t c = 0; c < SweepSums::components; ++c)
                            total[v * SweepSums::components + c] += worker.sums->values[c * worker.sums->slots + i];
                    }
        });
        clock.lap("merge");
    }
    result.average.resize(strands.vertex_count());
    for (std::size_t v = 0; v < result.average.size(); ++v)
        result.average[v] = static_cast<float>(total[v * 4]) / scale / static_cast<float>(settings.directions);
    clock.lap("end");
    return result;
}

}  // namespace hairbake
