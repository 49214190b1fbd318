// Computes A, the other arrays that the request asks for, and A's error bar from the hair in memory.
#include <cstdio>
#include <iterator>
#include <optional>

#include "core/base/naming_file.h"
#include "core/hair/strand_warnings.h"
#include "core/output/result_files.h"
#include "core/reference/tracer.h"
#include "core/stages/stage_table.h"
#include "core/stages/transmittance_method.h"
#include "core/visibility/direction_set.h"
#include "core/volume/hair_volume.h"
#include "core/volume/opacity_transmittance.h"

namespace hairbake {
namespace {

/// Transmittance by tracing the true strands.
Transmittance trace_all(const StrandScene& scene, const TransmittanceScene& baked,
                        const TransmittanceSettings& settings, Progress& progress) {
    const std::vector<std::uint32_t> vertices = all_vertices(scene.strands());
    const int count = traced_directions(settings.directions);
    const auto directions = make_directions(settings.direction_set, count, settings.seed);
    const double hair_share = baked.receiver ? 0.9 : 1.0;
    ProgressPart hair = progress.part(0, hair_share), receiver = progress.part(hair_share, 1);
    Transmittance transmittance;
    DirectionalMeans means =
        trace_directional(scene, vertices, directions, settings.sh_bands, settings.bent_cone, hair);
    transmittance.average = std::move(means.average);
    transmittance.sh = std::move(means.sh);
    transmittance.bent_cone = std::move(means.bent_cone);
    if (baked.receiver)
        transmittance.receiver =
            trace_receiver(scene, *baked.receiver, baked.receiver_is_occluder, directions, receiver);
    transmittance.directions = count;
    return transmittance;
}

/// Adds density.vdb's grid, which tracing does not need.
void add_density(const TransmittanceScene& baked, const TransmittanceSettings& settings, Transmittance& transmittance,
                 Progress& progress) {
    if (!baked.keep_density || baked.strands.vertex_count() == 0) return;
    describe_voxels(make_hair_volume(baked.strands, settings, progress), true, transmittance);
}

/// Runs `method`. Makes `scene` where that is trace.
Transmittance transmittance_of(TransmittanceMethod method, const TransmittanceScene& baked,
                               const TransmittanceSettings& settings, std::optional<StrandScene>& scene,
                               Progress& progress) {
    if (method == TransmittanceMethod::trace) {
        ProgressPart building = progress.part(0, 0.1), tracing = progress.part(0.1, 0.95),
                     grid = progress.part(0.95, 1);
        scene.emplace(baked.strands, building, baked.occluder);
        Transmittance traced = trace_all(*scene, baked, settings, tracing);
        add_density(baked, settings, traced, grid);
        return traced;
    }
    if (method == TransmittanceMethod::opacity_maps) return bake_transmittance_opacity_maps(baked, settings, progress);
    return bake_transmittance_volume(baked, settings, progress);
}

std::vector<float>& values_of(Transmittance& baked, const ArrayKind& kind) {
    if (&kind == &average_transmittance_kind()) return baked.average;
    if (&kind == &transmittance_sh_kind()) return baked.sh;
    if (&kind == &bent_cone_kind()) return baked.bent_cone;
    if (&kind == &receiver_kind()) return baked.receiver;
    for (NamedArray& other : baked.others)
        if (other.name == kind.name) return other.values;
    return baked.others.emplace_back(NamedArray{kind.name, {}}).values;  // of a model without vertices
}

/// Every array of this stage that the request asks for, also where the model has no vertices.
void add_arrays(Transmittance& baked, const BakeRequest& request, StagePart& part) {
    for (const NamedArray& other : baked.others)
        if (!find_array_kind(other.name))
            throw Error(ErrorKind::internal, "the array " + std::string(other.name) + " is in no row of array_kinds()");
    for (const ArrayKind& kind : array_kinds())
        if (const std::size_t components = kind.components(request); components && kind.stage == part.stage->name)
            part.arrays.push_back({&kind, components, std::move(values_of(baked, kind))});
}

/// A sentence where the error bar is large, or tells little.
std::vector<std::string> error_bar_warnings(const ErrorBar& bar) {
    constexpr double large = 0.05;
    constexpr std::uint32_t notable = 20;  // one in so many vertices inside other strands
    const std::uint32_t drawn = bar.outside.vertices + bar.inside_strand;
    std::vector<std::string> warnings;
    char text[200];
    if (bar.outside.rmse > large) {
        std::snprintf(text, sizeof text,
                      "the error of A is large: RMSE %.3f, bias %+.3f, against traced strands; "
                      "transmittance.method = trace is exact but slow",
                      bar.outside.rmse, bar.outside.bias);
        warnings.emplace_back(text);
    }
    if (drawn > 0 && bar.outside.vertices == 0)
        warnings.emplace_back("the error of A is not known: every vertex drawn lies inside another strand");
    else if (bar.inside_strand * notable > drawn)
        warnings.push_back(std::to_string(bar.inside_strand) + " of " + std::to_string(drawn) +
                           " vertices drawn lie inside other strands, where the traced A is 0: are the widths too "
                           "large? strand.width_scale makes them smaller");
    return warnings;
}

void append(std::vector<std::string>& all, std::vector<std::string> more) {
    std::move(more.begin(), more.end(), std::back_inserter(all));
}

}  // namespace

void run_transmittance_stage(StageContext& context, StagePart& part) {
    const BakeRequest& request = context.request;
    const TransmittanceSettings& settings = request.transmittance;
    check_outputs(request, context.inputs.hair());
    std::optional<StrandScene> scene;
    Transmittance baked;
    TransmittanceFacts facts;
    context.clock.run("transmittance", [&](Progress& progress) {
        const StrandGeometry& strands = context.inputs.strands();
        TransmittanceScene what{strands, context.inputs.occluder()};
        what.receiver = context.inputs.receiver();
        what.receiver_is_occluder = context.inputs.receiver_is_occluder();
        what.keep_density = request.wants("vdb");
        ChosenMethod chosen =
            choose_method(settings, strands.vertex_count(), what.receiver ? what.receiver->positions.size() : 0);
        naming_file(*request.hair, [&] { baked = transmittance_of(chosen.method, what, settings, scene, progress); });
        facts.method = chosen.method;
        facts.method_reason = std::move(chosen.reason);
        facts.degenerate_segments = strands.degenerate_segment_count;
    });
    part.warnings = std::move(baked.warnings);
    append(part.warnings, strand_warnings(context.inputs.strands()));
    if (settings.reference_vertices > 0)
        context.clock.run("reference", [&](Progress& progress) {
            ProgressPart building = progress.part(0, 0.5), tracing = progress.part(0.5, 1);
            if (!scene) scene.emplace(context.inputs.strands(), building, context.inputs.occluder());
            facts.error_bar = measure_error(*scene, baked.average, settings.reference_vertices, settings.seed, tracing);
            append(part.warnings, error_bar_warnings(*facts.error_bar));
        });
    facts.directions = baked.directions;
    facts.voxel_size = baked.voxel_size;
    facts.voxel_reason = baked.voxel_reason;
    facts.occupied_voxels = baked.occupied_voxels;
    facts.density = std::move(baked.density);
    add_arrays(baked, request, part);
    part.facts = std::move(facts);
}

}  // namespace hairbake
