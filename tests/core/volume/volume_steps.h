// The steps of the volume method one by one, as bake_transmittance_volume() runs them.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "core/volume/hair_volume.h"
#include "core/volume/near_field.h"
#include "core/volume/point_slots.h"
#include "core/volume/slice_layout.h"
#include "core/volume/sweep.h"
#include "core/volume/weight_reader.h"

namespace hairbake::test_support {

inline HairVolume volume_of(const StrandGeometry& strands, const TransmittanceSettings& settings) {
    Progress progress;
    return make_hair_volume(strands, settings, progress);
}

/// The hair's vertices, in the order of SortedStrands. Refers to `volume`.
inline PointSet vertices_of(const HairVolume& volume) {
    return {.positions = volume.sorted.vertex_positions,
            .model_index = volume.sorted.vertices,
            .vectors = {},
            .shadow = nullptr};
}

/// Sums of one walk at every point of the reader's set, without shadow: [point * components + component].
inline std::vector<double> walk_sums(const HairVolume& volume, std::span<const Vec3d> directions,
                                     std::span<const std::uint32_t> walk, const SweepReader& reader) {
    Progress progress;
    const Vec3d& l = directions[walk[0]];
    int axis = 0;
    for (int a = 1; a < 3; ++a)
        if (std::abs(l[a]) > std::abs(l[axis])) axis = a;
    const SliceLayout layout = make_slice_layout(volume, axis, progress);
    const PointSlots slots = make_point_slots(volume, layout, reader.points());
    const std::size_t components = reader.scales().size();
    SweepSums sums(slots.size(), components);
    const SweepReader* readers[] = {&reader};
    const SweepStop stop{slots, {}, readers, std::span(&sums, 1)};
    SweepScratch scratch;
    sweep(layout, directions, walk, std::span(&stop, 1), scratch);
    std::vector<double> of_points(reader.points().size() * components);
    for (std::size_t i = 0; i < slots.size(); ++i)
        if (slots.point[i] != PointSlots::no_point)
            for (std::size_t c = 0; c < components; ++c)
                of_points[slots.point[i] * components + c] =
                    double(sums.values[c * sums.slots + i]) / double(reader.scales()[c]);
    return of_points;
}

/// Transmittance of every vertex in one direction, by the sweep alone; in the model's order.
inline std::vector<float> sweep_one(const HairVolume& volume, const Vec3d& l) {
    const PointSet vertices = vertices_of(volume);
    const WeightReader reader(vertices, {1}, {sweep_scale(1)});
    const std::uint32_t walk[] = {0};
    const auto sums = walk_sums(volume, std::span(&l, 1), walk, reader);
    std::vector<float> t(sums.size());
    for (std::size_t place = 0; place < t.size(); ++place)
        t[volume.sorted.vertices[place]] = static_cast<float>(sums[place]);
    return t;
}

/// Means over directions, by the sweep alone, in the order of SortedStrands.
inline std::vector<AngularMean> sweep_means(const HairVolume& volume, std::span<const Vec3d> directions) {
    std::vector<AngularMean> means(volume.sorted.vertices.size());
    const auto n = static_cast<float>(directions.size());
    for (const Vec3d& l : directions) {
        const auto t = sweep_one(volume, l);
        for (std::size_t place = 0; place < t.size(); ++place) {
            const float t_v = t[volume.sorted.vertices[place]];
            means[place].average += t_v / n;
            means[place].slope += Vec3f(l) * (3 * t_v / n);
        }
    }
    return means;
}

}  // namespace hairbake::test_support
