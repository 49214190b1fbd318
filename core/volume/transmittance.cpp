#include "core/volume/transmittance.h"

#include <numeric>
#include <optional>
#include <span>
#include <string>

#include "core/base/error.h"
#include "core/visibility/direction_set.h"
#include "core/visibility/hemisphere_means.h"
#include "core/volume/density_grid.h"
#include "core/volume/direction_sweep.h"
#include "core/volume/functionals.h"
#include "core/volume/hair_volume.h"
#include "core/volume/point_shadow.h"
#include "core/volume/vertex_points.h"

namespace hairbake {
namespace {

/// The occluder's shadow on the receiver; none without an occluder or where the receiver is the occluder.
std::optional<PointShadow> shadow_on_receiver(const TransmittanceScene& scene, Progress& progress) {
    if (!scene.receiver || !scene.occluder || scene.receiver_is_occluder) return std::nullopt;
    return std::optional<PointShadow>(std::in_place, scene.receiver->positions, *scene.occluder,
                                      shadow_scale(scene.strands.positions, *scene.occluder), progress);
}

/// The receiver's means where there is no hair: only the occluder, if any, is in the way.
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
        shadow->occluder().visible(points, directions.subspan(k, 1), progress, raster, seen);
        for (std::size_t i = 0; i < count; ++i) sums[i].add(seen[i], dot(Vec3d(receiver.normals[i]), directions[k]));
    }
    std::vector<float> answers;
    for (const HemisphereSums& sum : sums)
        for (const float mean : sum.means()) answers.push_back(mean);
    return answers;
}

/// The receiver's positions in grid space.
std::vector<Vec3f> receiver_positions(const TransmittanceScene& scene, const GridFrame& frame) {
    std::vector<Vec3f> positions;
    if (!scene.receiver) return positions;
    const std::size_t count = scene.receiver->positions.size();
    if (count >> 31)
        throw Error(ErrorKind::out_of_resources,
                    "the receiver has " + std::to_string(count) + " positions; fewer than 2147483648 are allowed",
                    "receiver");
    positions.reserve(count);
    for (const Vec3f& p : scene.receiver->positions) positions.push_back(frame.to_grid(p));
    return positions;
}

std::vector<std::unique_ptr<Functional>> make_functionals(const FunctionalInput& input) {
    std::vector<std::unique_ptr<Functional>> functionals;
    for (const MakeFunctional make : kFunctionals)
        if (auto functional = make(input)) functionals.push_back(std::move(functional));
    return functionals;
}

/// Sweeps for all functionals, corrects their near field in one pass, and lets them answer.
void evaluate(const FunctionalInput& input, const HairVolume& volume, Progress& progress, Transmittance& result) {
    const auto functionals = make_functionals(input);
    std::vector<const SweepReader*> readers;
    for (const auto& functional : functionals) readers.push_back(&functional->reader());
    ProgressPart sweeping = progress.part(0, 0.6);
    const auto sums = sweep_directions(volume, input.directions, readers, sweeping);

    std::vector<std::vector<AngularMean>> means;
    std::vector<std::size_t> begin{0};  // of each functional's means
    for (std::size_t i = 0; i < functionals.size(); ++i) {
        for (auto& mean : functionals[i]->near_field_means(sums[i])) means.push_back(std::move(mean));
        begin.push_back(means.size());
    }
    auto corrected = correct_near_field(input.scene.strands, volume, means, progress);
    for (std::size_t i = 0; i < functionals.size(); ++i)
        functionals[i]->answer(sums[i], std::span(corrected).subspan(begin[i], begin[i + 1] - begin[i]), result);
}

}  // namespace

void describe_voxels(const HairVolume& volume, bool keep_density, Transmittance& transmittance) {
    transmittance.voxel_size = volume.frame.voxel_size;
    transmittance.voxel_reason = volume.frame.reason;
    transmittance.occupied_voxels = volume.bricks.occupied_voxels;
    if (keep_density) transmittance.density = std::make_shared<const DensityGrid>(volume);
}

Transmittance bake_transmittance_volume(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                        Progress& progress) {
    const auto directions = make_directions(settings.direction_set, settings.directions, settings.seed);
    Transmittance result;
    result.directions = settings.directions;
    const std::optional<PointShadow> receiver_shadow = shadow_on_receiver(scene, progress);
    if (scene.strands.vertex_count() == 0) {
        if (scene.receiver)
            result.receiver = receiver_without_hair(*scene.receiver, receiver_shadow, directions, progress);
        return result;
    }
    ProgressPart building = progress.part(0, 0.3), evaluating = progress.part(0.3, 1);
    const HairVolume volume = make_hair_volume(scene.strands, settings, building);
    if (volume.frame.reason == VoxelReason::width && (settings.voxels || settings.voxel_size))
        result.warnings.push_back(
            "the strands are too wide for the voxels asked for: a voxel is twice the 95th "
            "percentile of the widths, " +
            std::to_string(volume.frame.voxel_size) + " model units");

    const VertexPoints vertices(scene, volume, progress);
    const std::vector<Vec3f> positions = receiver_positions(scene, volume.frame);
    PointSet receiver{.positions = positions, .model_index = {}, .vectors = {}, .shadow = {}};
    if (scene.receiver) receiver.vectors = scene.receiver->normals;
    if (receiver_shadow) receiver.shadow = &*receiver_shadow;
    evaluate({scene, settings, directions, vertices.points(), scene.receiver ? &receiver : nullptr}, volume, evaluating,
             result);
    describe_voxels(volume, scene.keep_density, result);
    progress.report(1);
    return result;
}

}  // namespace hairbake
