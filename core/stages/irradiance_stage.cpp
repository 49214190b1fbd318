// Computes irradiance maps from an environment, both in memory.
#include "core/stages/stage_table.h"

namespace hairbake {

void run_irradiance_stage(StageContext& context, StagePart& part) {
    const IrradianceSettings& settings = context.request.irradiance;
    IrradianceMaps maps;
    context.clock.run("irradiance", [&](Progress& progress) {
        maps = bake_irradiance(context.inputs.environment(), settings, context.request.fiber, progress);
    });
    part.warnings = std::move(maps.warnings);
    part.maps = to_map_set(maps, context.request.fiber);
    part.facts = IrradianceFacts{std::move(maps.environment_sh),
                                 maps.environment_sh_bands,
                                 maps.interpolation_bound,
                                 maps.interpolation_bound_relative,
                                 settings.method == IrradianceMethod::sh,
                                 maps.sh_bands_diffuse,
                                 maps.sh_bands_specular,
                                 maps.predicted_error_diffuse,
                                 maps.predicted_error_specular};
}

}  // namespace hairbake
