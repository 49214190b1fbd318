// Computes the transmittance under the bake's own light (effective_table.h).
#include <algorithm>
#include <optional>

#include "core/base/luminance.h"
#include "core/base/naming_file.h"
#include "core/environment/light_clusters.h"
#include "core/hair/tangents.h"
#include "core/irradiance/effective_table.h"
#include "core/reference/neighborhood_error.h"
#include "core/reference/tracer.h"
#include "core/stages/stage_table.h"
#include "core/stages/transmittance_method.h"
#include "core/volume/weighted_transmittance.h"

namespace hairbake {
namespace {

constexpr std::uint64_t neighborhood_seed = 1;

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

/// What the sums are made of.
struct LightTable {
    std::vector<Vec3d> directions;
    EffectiveTable weights;
    std::vector<std::uint32_t> cells;  ///< [V]

    DirectionWeights sums() const { return {weights.components, weights.lights, weights.values, cells}; }
    /// The unblocked diffuse light.
    DirectionWeights light() const { return {1, weights.lights, weights.diffuse_light, cells}; }
};

/// Makes `scene` where the method is trace.
std::vector<float> sum_up(TransmittanceMethod method, StageContext& context, const LightTable& table,
                          std::optional<StrandScene>& scene, Progress& progress) {
    const StrandGeometry& strands = context.inputs.strands();
    if (method != TransmittanceMethod::trace)
        return sum_weighted_volume({strands, context.inputs.occluder()}, context.request.transmittance,
                                   table.directions, table.sums(), progress);
    ProgressPart building = progress.part(0, 0.1), tracing = progress.part(0.1, 1);
    scene.emplace(strands, building, context.inputs.occluder());
    return trace_weighted(*scene, all_vertices(strands), table.directions, table.sums(), tracing);
}

/// [V], the luminance of the diffuse light that arrives.
std::vector<float> diffuse_light(const LightTable& table, std::span<const float> values, std::size_t diffuse) {
    std::vector<float> light(table.cells.size());
    for (std::size_t v = 0; v < light.size(); ++v) {
        const float* ad = &values[v * table.weights.components];
        const Vec3d all(table.weights.diffuse[table.cells[v]]);
        const Vec3d share = diffuse == 3 ? Vec3d{ad[0], ad[1], ad[2]} : Vec3d(ad[0]);
        light[v] = static_cast<float>(luminance(Vec3d{all.x * share.x, all.y * share.y, all.z * share.z}));
    }
    return light;
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
    const auto diffuse = static_cast<std::size_t>(settings.diffuse_components());
    EffectiveFacts facts;
    LightTable table;
    std::vector<float> values;
    std::optional<StrandScene> scene;
    context.clock.run("effective_transmittance", [&](Progress& progress) {
        const auto model = make_fiber_model(request.fiber);
        zonal_kernels_for_maps(*model, request.fiber);
        ChosenMethod chosen = choose_method(request.transmittance, context.inputs.strands().vertex_count(), 0);
        ProgressPart fitting = progress.part(0, 0.2), summing = progress.part(0.2, 1);
        facts.lights = gather_lights(context.inputs.environment(), request,
                                     wanted_lights(settings, model->sharpness(), chosen.method), progress);
        for (const ClusteredLight& light : facts.lights) table.directions.push_back(light.direction);
        table.weights = make_effective_table(facts.lights, *model, settings, fitting);
        table.cells = cells_of(context.inputs.hair(), table.weights);
        naming_file(*request.hair, [&] { values = sum_up(chosen.method, context, table, scene, summing); });
        clamp_diffuse(values, table.weights.components, diffuse);
        facts.method = chosen.method;
        facts.method_reason = std::move(chosen.reason);
    });
    if (settings.reference_neighborhoods > 0)
        context.clock.run("effective_reference", [&](Progress& progress) {
            ProgressPart building = progress.part(0, 0.4), tracing = progress.part(0.4, 1);
            if (!scene) scene.emplace(context.inputs.strands(), building, context.inputs.occluder());
            facts.error =
                measure_neighborhoods(*scene, table.directions, table.light(), diffuse_light(table, values, diffuse),
                                      settings.reference_neighborhoods, neighborhood_seed, tracing);
        });
    facts.face_size = table.weights.face_size;
    facts.diffuse_components = settings.diffuse_components();
    facts.cosines = settings.cosines;
    part.arrays.push_back({&effective_transmittance_kind(), table.weights.components, std::move(values)});
    part.facts = std::move(facts);
}

}  // namespace hairbake
