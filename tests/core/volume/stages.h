// The stages of the volume method one by one, as bake_transmittance_volume() runs them.
#pragma once

#include <span>
#include <vector>

#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/near_field.h"
#include "core/volume/slice_layout.h"
#include "core/volume/strand_pieces.h"
#include "core/volume/sweep.h"

namespace hairbake::test_support {

struct Stages {
    GridFrame frame;
    bool bounded_by_width = false;
    SortedStrands sorted;
    ExtinctionBricks bricks;

    Stages(const StrandGeometry& strands, const TransmittanceSettings& settings) {
        Progress progress;
        frame = make_grid_frame(strands, settings, &bounded_by_width);
        sorted = sort_strands(strands, frame, progress);
        bricks = deposit_strands(sorted, progress);
    }
};

/// Transmittance of every vertex in one direction, by the sweep alone.
inline std::vector<float> sweep_one(const StrandGeometry& strands, const Stages& stages, const Vec3d& l) {
    Progress progress;
    int axis = 0;
    for (int a = 1; a < 3; ++a)
        if (std::abs(l[a]) > std::abs(l[axis])) axis = a;
    const SliceLayout layout = make_slice_layout(stages.frame, stages.sorted, stages.bricks, axis, progress);
    SweepScratch scratch;
    SweepSums sums(layout.slot_vertex.size());
    sweep(layout, std::span(&l, 1), sweep_scale(1), {}, scratch, sums);
    std::vector<float> t(strands.vertex_count());
    for (std::size_t i = 0; i < layout.slot_vertex.size(); ++i)
        if (layout.slot_vertex[i] != SliceLayout::no_vertex)
            t[stages.sorted.vertices[layout.slot_vertex[i]]] = static_cast<float>(sums.values[i]) / sweep_scale(1);
    return t;
}

/// Means over directions, by the sweep alone, in the order of SortedStrands.
inline std::vector<AngularMean> sweep_means(const StrandGeometry& strands, const Stages& stages,
                                            std::span<const Vec3d> directions) {
    std::vector<AngularMean> means(strands.vertex_count());
    const auto n = static_cast<float>(directions.size());
    for (const Vec3d& l : directions) {
        const auto t = sweep_one(strands, stages, l);
        for (std::size_t place = 0; place < t.size(); ++place) {
            const float t_v = t[stages.sorted.vertices[place]];
            means[place].average += t_v / n;
            means[place].slope += Vec3f(l) * (3 * t_v / n);
        }
    }
    return means;
}

}  // namespace hairbake::test_support
