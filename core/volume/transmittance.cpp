#include "core/volume/transmittance.h"

#include <string>

#include "core/base/direction_moments.h"
#include "core/volume/density_grid.h"
#include "core/volume/direction_sweep.h"
#include "core/volume/directional_answers.h"
#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/near_field.h"
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

}  // namespace

Transmittance bake_transmittance_volume(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                        Progress& progress) {
    const StrandGeometry& strands = scene.strands;
    const auto directions = make_directions(settings.direction_set, settings.directions, settings.seed);
    Transmittance result;
    result.directions = settings.directions;
    if (strands.vertex_count() == 0) {
        if (scene.receiver) result.receiver.assign(2 * scene.receiver->positions.size(), 1);
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
    progress.report("transmittance", 0.2);
    const ExtinctionBricks bricks = deposit_strands(sorted, progress);
    progress.report("transmittance", 0.3);
    result.density = std::make_shared<const DensityGrid>(frame, sorted, bricks);
    result.occupied_voxels = result.density->occupied_voxels();

    // The sweep always sums up four moments: the near-field correction needs them.
    const DirectionMoments moments(directions, settings.sh_bands, true);
    const DirectionSums sums =
        sweep_directions(frame, sorted, bricks, {directions, moments, true, scene.receiver}, progress, 0.3, 0.7);
    auto average =
        correct_near_field(strands, frame, sorted, bricks, angular_means(sums.vertices, directions.size()), progress);
    DirectionalMeans answers = directional_answers(sums.vertices, sorted.vertices, std::move(average),
                                                   directions.size(), settings.sh_bands, settings.bent_cone);
    result.average = std::move(answers.average);
    result.sh = std::move(answers.sh);
    result.bent_cone = std::move(answers.bent_cone);
    if (scene.receiver) result.receiver = answer_receiver(sums.receivers, result.warnings);
    progress.report("transmittance", 1);
    return result;
}

}  // namespace hairbake
