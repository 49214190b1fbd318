// Computes the transmittance under the bake's own light (effective_table.h).
#include <algorithm>

#include "core/base/naming_file.h"
#include "core/environment/light_clusters.h"
#include "core/hair/tangents.h"
#include "core/irradiance/effective_table.h"
#include "core/reference/tracer.h"
#include "core/stages/stage_table.h"
#include "core/stages/transmittance_method.h"
#include "core/volume/weighted_transmittance.h"

namespace hairbake {
namespace {

/// Directions that stand for the environment. A traced ray knows only its own line, so tracing takes more of them.
std::size_t wanted_lights(const EffectiveSettings& settings, double sharpness, TransmittanceMethod method) {
    const double count = settings.lights * effective_refinement(sharpness);
    const auto swept = static_cast<int>(std::min(count + 0.5, 4096.0));
    return static_cast<std::size_t>(method == TransmittanceMethod::trace ? traced_directions(swept) : swept);
}

std::vector<ClusteredLight> gather_lights(const EnvironmentMap& map, const BakeRequest& request, std::size_t count,
                                          const Progress& progress) {
    std::vector<ClusteredLight> lights =
        cluster_lights(make_light_set(map, clustered_resolution, progress), count, progress);
    const std::vector<ClusteredLight> added = as_clusters(request.irradiance.lights);
    lights.insert(lights.end(), added.begin(), added.end());
    if (lights.empty()) lights.push_back({Vec3d{0, 1, 0}, Vec3d()});  // no light at all: any direction will do
    return lights;
}

std::vector<std::uint32_t> cells_of(const HairModel& hair, const EffectiveTable& table) {
    std::vector<std::uint32_t> cells;
    for (const Vec3f& tangent : vertex_tangents(hair)) cells.push_back(table.cell_of(tangent));
    return cells;
}

std::vector<float> sum_up(TransmittanceMethod method, StageContext& context, const std::vector<Vec3d>& directions,
                          const DirectionWeights& weights, Progress& progress) {
    const StrandGeometry& strands = context.inputs.strands();
    if (method != TransmittanceMethod::trace)
        return sum_weighted_volume({strands, context.inputs.occluder()}, context.request.transmittance, directions,
                                   weights, progress);
    ProgressPart building = progress.part(0, 0.1), tracing = progress.part(0.1, 1);
    const StrandScene scene(strands, building, context.inputs.occluder());
    return trace_weighted(scene, directions, weights, tracing);
}

/// Ad is a share of light that arrives: rounding may take it out of [0, 1]. The cosines' terms are signed.
void clamp_diffuse(std::vector<float>& values, std::size_t components, std::size_t diffuse) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (i % components < diffuse) values[i] = std::clamp(values[i], 0.0f, 1.0f);
}

}  // namespace

void run_effective_transmittance_stage(StageContext& context, StagePart& part) {
    const BakeRequest& request = context.request;
    const EffectiveSettings& settings = request.effective_transmittance;
    EffectiveFacts facts;
    context.clock.run("effective_transmittance", [&](Progress& progress) {
        const auto model = make_fiber_model(request.fiber);
        zonal_kernels_for_maps(*model, request.fiber);
        ChosenMethod chosen = choose_method(request.transmittance, context.inputs.strands().vertex_count(), 0);
        ProgressPart fitting = progress.part(0, 0.2), summing = progress.part(0.2, 1);
        facts.lights = gather_lights(context.inputs.environment(), request,
                                     wanted_lights(settings, model->sharpness(), chosen.method), progress);
        const EffectiveTable table = make_effective_table(facts.lights, *model, settings, fitting);
        const std::vector<std::uint32_t> cells = cells_of(context.inputs.hair(), table);
        std::vector<Vec3d> directions;
        for (const ClusteredLight& light : facts.lights) directions.push_back(light.direction);
        const DirectionWeights weights{table.components, table.lights, table.values, cells};
        std::vector<float> values;
        naming_file(*request.hair, [&] { values = sum_up(chosen.method, context, directions, weights, summing); });
        const auto diffuse = static_cast<std::size_t>(settings.diffuse_components());
        clamp_diffuse(values, table.components, diffuse);
        part.arrays.push_back({&effective_transmittance_kind(), table.components, std::move(values)});
        facts.method = chosen.method;
        facts.method_reason = std::move(chosen.reason);
        facts.face_size = table.face_size;
    });
    facts.diffuse_components = settings.diffuse_components();
    facts.cosines = settings.cosines;
    part.facts = std::move(facts);
}

}  // namespace hairbake
