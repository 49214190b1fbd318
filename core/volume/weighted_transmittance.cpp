#include "core/volume/weighted_transmittance.h"

#include <cmath>

#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/volume/direction_sweep.h"
#include "core/volume/hair_volume.h"
#include "core/volume/own_shadow.h"
#include "core/volume/row_reader.h"
#include "core/volume/vertex_points.h"

namespace hairbake {
namespace {

/// Stores the sums, times what the own strand took, in the model's order.
void store_sums(const TransmittanceScene& scene, const HairVolume& volume, const FixedPointSums& sums,
                const Progress& progress, std::span<float> answers) {
    const NearFieldWindow window;
    const OwnShadow own;
    const std::size_t components = sums.components();
    parallel_for(sums.points(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t place = begin; place < end; ++place) {
            const std::uint32_t v = volume.sorted.vertices[place];
            const Vec3f no_slope;
            OwnShadow::Depth depth;
            own.depths(scene.strands, volume.frame, window, v, {&no_slope, 1}, {&depth, 1});
            const float factor = std::exp(depth.swept);
            for (std::size_t c = 0; c < components; ++c)
                answers[v * components + c] = static_cast<float>(sums.of(place)[c]) / sums.scale(c) * factor;
        }
    });
}

}  // namespace

std::vector<float> sum_weighted_volume(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                       std::span<const Vec3d> directions, const DirectionWeights& weights,
                                       Progress& progress) {
    HAIRBAKE_ASSERT(directions.size() == weights.directions);
    std::vector<float> answers(scene.strands.vertex_count() * weights.components);
    if (answers.empty()) return answers;
    ProgressPart building = progress.part(0, 0.4), sweeping = progress.part(0.4, 1);
    const HairVolume volume = make_hair_volume(scene.strands, settings, building);
    const VertexPoints vertices(scene, volume, progress);
    const RowReader reader(vertices.points(), weights);
    const SweepReader* const readers[] = {&reader};
    const auto sums = sweep_directions(volume, directions, readers, sweeping);
    store_sums(scene, volume, sums[0], progress, answers);
    return answers;
}

}  // namespace hairbake
