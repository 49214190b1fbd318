#include "core/stages/stage_table.h"

#include "core/base/error.h"

namespace hairbake {

StageFunction run_transmittance_stage, run_irradiance_stage, run_effective_transmittance_stage;

namespace {

struct StageCode {
    std::string_view stage;
    StageFunction* run;
};

constexpr StageCode table[] = {
    {"transmittance", run_transmittance_stage},
    {"irradiance", run_irradiance_stage},
    {"effective_transmittance", run_effective_transmittance_stage},
};

}  // namespace

StagePart run_stage(const Stage& stage, StageContext& context) {
    for (const StageCode& code : table) {
        if (code.stage != stage.name) continue;
        StagePart part;
        part.stage = &stage;
        part.key = stage_key(stage, context.inputs.digests(), context.request);
        code.run(context, part);
        return part;
    }
    throw Error(ErrorKind::internal, "the stage " + std::string(stage.name) + " has no code");
}

}  // namespace hairbake
