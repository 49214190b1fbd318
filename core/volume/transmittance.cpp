#include "core/volume/transmittance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/volume/density_grid.h"
#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/hair_shadow.h"
#include "core/volume/near_field.h"
#include "core/volume/slice_layout.h"
#include "core/volume/strand_pieces.h"
#include "core/volume/sweep.h"

namespace hairbake {
namespace {

/// Walks along one axis that run at the same time at most, whatever the machine: each thread has sums of its own, 16
/// bytes a vertex.
constexpr std::size_t kMostWalks = 16;

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

/// Sums over the directions of every axis, by vertex in the order of SortedStrands: [V * SweepSums::components], as
/// integers of the same scale.
class VertexSums {
public:
    explicit VertexSums(std::size_t vertex_count) : values_(vertex_count * SweepSums::components) {}

    void add(const SliceLayout& layout, std::span<const SweepSums> parts) {
        parallel_for(layout.slot_vertex.size(), 1 << 15, [&](std::size_t begin, std::size_t end) {
            for (const SweepSums& part : parts)
                for (std::size_t i = begin; i < end && part.slots > 0; ++i) {
                    if (layout.slot_vertex[i] == SliceLayout::no_vertex) continue;
                    std::int32_t* sum = &values_[std::size_t{layout.slot_vertex[i]} * SweepSums::components];
                    for (std::size_t c = 0; c < SweepSums::components; ++c) sum[c] += part.values[c * part.slots + i];
                }
        });
    }

    std::vector<AngularMean> means(float scale, int directions) const {
        std::vector<AngularMean> means(values_.size() / SweepSums::components);
        const float unit = 1 / (scale * static_cast<float>(directions));
        parallel_for(means.size(), 1 << 15, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                const std::int32_t* sum = &values_[v * SweepSums::components];
                const Vec3f slope{static_cast<float>(sum[1]), static_cast<float>(sum[2]), static_cast<float>(sum[3])};
                means[v] = {static_cast<float>(sum[0]) * unit, slope * (3 * unit)};
            }
        });
        return means;
    }

private:
    std::vector<std::int32_t> values_;
};

/// The occluder as the slots of one axis see it.
struct SlotShadow {
    const HairShadow* hair;
    OccluderShadow::Points points;
};

/// Sweeps all groups of one axis and adds what they bring. `swept` is told how many directions are done.
void sweep_axis(const SliceLayout& layout, std::span<const std::vector<Vec3d>> groups, float scale,
                const SlotShadow* shadow, Progress& progress, const std::function<void(std::size_t)>& swept,
                VertexSums& total) {
    const std::size_t walks = std::min(groups.size(), kMostWalks);
    std::vector<SweepSums> sums(walks, SweepSums(0));
    std::atomic<std::size_t> next{0};
    parallel_for(walks, 1, [&](std::size_t w, std::size_t) {
        SweepScratch scratch;
        OccluderShadow::Scratch raster;
        std::vector<std::uint8_t> seen;
        for (std::size_t g = next++; g < groups.size(); g = next++) {
            progress.check();
            if (sums[w].slots == 0) sums[w] = SweepSums(layout.slot_vertex.size());
            if (shadow) shadow->hair->occluder().look(shadow->points, groups[g], progress, raster, seen);
            sweep(layout, groups[g], scale, seen, scratch, sums[w]);
            swept(groups[g].size());
        }
    });
    total.add(layout, sums);
}

/// [V], in the order of SortedStrands.
std::vector<AngularMean> sweep_all(const GridFrame& frame, const SortedStrands& sorted, const ExtinctionBricks& bricks,
                                   std::span<const Vec3d> directions, const HairShadow* shadow, Progress& progress) {
    const int count = static_cast<int>(directions.size());
    const float scale = sweep_scale(count);
    VertexSums total(sorted.vertices.size());
    std::atomic<std::size_t> done{0};
    for (int axis = 0; axis < 3; ++axis) {
        const auto groups = group_directions(directions, axis);
        if (groups.empty()) continue;
        const SliceLayout layout = make_slice_layout(frame, sorted, bricks, axis, progress);
        const auto swept = [&](std::size_t n) {
            progress.report("transmittance", 0.3 + 0.4 * static_cast<double>(done += n) / count);
        };
        std::optional<SlotShadow> slots;
        if (shadow) slots = SlotShadow{shadow, shadow->points(layout, sorted)};
        sweep_axis(layout, groups, scale, slots ? &*slots : nullptr, progress, swept, total);
    }
    return total.means(scale, count);
}

}  // namespace

Transmittance bake_transmittance_volume(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                        Progress& progress) {
    const StrandGeometry& strands = scene.strands;
    const auto directions = make_directions(settings.direction_set, settings.directions, settings.seed);
    Transmittance result;
    result.directions = settings.directions;
    if (strands.vertex_count() == 0) return result;
    bool bounded_by_width = false;
    const GridFrame frame = make_grid_frame(strands, settings, &bounded_by_width);
    result.voxel_size = frame.voxel_size;
    if (bounded_by_width)
        result.warnings.push_back(
            "the strands are too wide for the voxels asked for: a voxel is twice the 95th "
            "percentile of the widths, " +
            std::to_string(frame.voxel_size) + " model units");

    const SortedStrands sorted = sort_strands(strands, frame, progress);
    progress.report("transmittance", 0.2);
    const ExtinctionBricks bricks = deposit_strands(sorted, progress);
    progress.report("transmittance", 0.3);
    result.density = std::make_shared<const DensityGrid>(frame, sorted, bricks);
    result.occupied_voxels = result.density->occupied_voxels();

    std::optional<HairShadow> shadow;
    if (scene.occluder) shadow.emplace(strands, *scene.occluder, progress);
    const auto means = sweep_all(frame, sorted, bricks, directions, shadow ? &*shadow : nullptr, progress);
    result.average = correct_near_field(strands, frame, sorted, bricks, means, progress);
    progress.report("transmittance", 1);
    return result;
}

}  // namespace hairbake
