#include "core/volume/transmittance.h"

#include <numeric>
#include <optional>
#include <span>
#include <string>

#include "core/visibility/direction_moments.h"
#include "core/visibility/direction_set.h"
#include "core/visibility/hemisphere_means.h"
#include "core/volume/density_grid.h"
#include "core/volume/direction_sweep.h"
#include "core/volume/directional_answers.h"
#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/near_field.h"
#include "core/volume/point_shadow.h"
#include "core/volume/strand_pieces.h"

namespace hairbake {
namespace {

std::vector<float> answer_receiver(const ItemSums& sums, std::vector<std::string>& warnings) {
    std::size_t without_direction = 0;
    auto answers = receiver_answers(sums, &without_direction);
    if (without_direction > 0)
        warnings.push_back(std::to_string(without_direction) +
                           " of the receiver's points have no direction above their plane and count as not shadowed: "
                           "ask for more directions (transmittance.directions)");
    return answers;
}

/// Only the occluder, if any, is in the way.
std::vector<float> receiver_without_hair(const TriangleMesh& receiver, const std::optional<PointShadow>& shadow,
                                         std::span<const Vec3d> directions, const Progress& progress) {
    const std::size_t count = receiver.positions.size();
    if (!shadow) return std::vector<float>(2 * count, 1);
    std::vector<std::uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0u);
    const OccluderShadow::Points points = shadow->points(all);
    OccluderShadow::Scratch raster;
    std::vector<std::uint8_t> seen;
    std::vector<HemisphereSums> sums(count);
    for (std::size_t k = 0; k < directions.size(); ++k) {
        shadow->occluder().look(points, directions.subspan(k, 1), progress, raster, seen);
        for (std::size_t i = 0; i < count; ++i) sums[i].add(seen[i], dot(Vec3d(receiver.normals[i]), directions[k]));
    }
    std::vector<float> answers;
    for (const HemisphereSums& sum : sums)
        for (const float mean : sum.means()) answers.push_back(mean);
    return answers;
}

}  // namespace

Transmittance bake_transmittance_volume(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                        Progress& progress) {
    const StrandGeometry& strands = scene.strands;
    const auto directions = make_directions(settings.direction_set, settings.directions, settings.seed);
    Transmittance result;
    result.directions = settings.directions;
    const bool receiver_is_shadowed = scene.receiver && scene.occluder && !scene.receiver_is_occluder;
    std::optional<PointShadow> vertex_shadow, receiver_shadow;
    if (receiver_is_shadowed)
        receiver_shadow.emplace(scene.receiver->positions, *scene.occluder,
                                shadow_scale(strands.positions, *scene.occluder), progress);
    if (strands.vertex_count() == 0) {
        if (scene.receiver)
            result.receiver = receiver_without_hair(*scene.receiver, receiver_shadow, directions, progress);
        return result;
    }
    bool bounded_by_width = false;
    const GridFrame frame = make_grid_frame(strands, settings, &bounded_by_width);
    result.voxel_size = frame.voxel_size;
    if (bounded_by_width)
        result.warnings.push_back(
            "the strands are too wide for the voxels asked for: a voxel is twice the 95th "
            "percentile of the widths, " +
            std::to_string(frame.voxel_size) + " model units");

    const SortedStrands sorted = sort_strands(strands, frame, progress);
    progress.report(0.2);
    const ExtinctionBricks bricks = deposit_strands(sorted, progress);
    progress.report(0.3);
    result.density = std::make_shared<const DensityGrid>(frame, sorted, bricks);
    result.occupied_voxels = result.density->occupied_voxels();

    // The sweep always sums up four moments: the near-field correction needs them.
    const DirectionMoments moments(directions, settings.sh_bands, true);
    SweepRequest request{directions, moments, scene.receiver};
    if (scene.occluder)
        vertex_shadow.emplace(strands.positions, *scene.occluder, shadow_scale(strands.positions, *scene.occluder),
                              progress);
    request.vertex_shadow = vertex_shadow ? &*vertex_shadow : nullptr;
    request.receiver_shadow = receiver_shadow ? &*receiver_shadow : nullptr;
    ProgressPart sweeping = progress.part(0.3, 0.7);
    const DirectionSums sums = sweep_directions(frame, sorted, bricks, request, sweeping);
    auto average =
        correct_near_field(strands, frame, sorted, bricks, angular_means(sums.vertices, directions.size()), progress);
    DirectionalMeans answers = directional_answers(sums.vertices, sorted.vertices, std::move(average),
                                                   directions.size(), settings.sh_bands, settings.bent_cone);
    result.average = std::move(answers.average);
    result.sh = std::move(answers.sh);
    result.bent_cone = std::move(answers.bent_cone);
    if (scene.receiver) result.receiver = answer_receiver(sums.receivers, result.warnings);
    progress.report(1);
    return result;
}

}  // namespace hairbake
