// The code of each stage. core/request/stages.h describes the stages; the table here has their functions.
#pragma once

#include "core/request/request.h"
#include "core/result/stage_part.h"
#include "core/stages/bake_inputs.h"
#include "core/stages/phase_clock.h"

namespace hairbake {

/// The input of a stage.
struct StageContext {
    const BakeRequest& request;
    BakeInputs& inputs;  ///< holds what the stage's row names as inputs
    PhaseClock& clock;
};

/// Reads the inputs of the stage and runs the stage.
/// Throws Error as bake().
StagePart run_stage(const Stage& stage, StageContext& context);

// One function a stage, each in a file of its own. `part` comes with stage and key; the function fills in the rest.
void run_transmittance_stage(StageContext& context, StagePart& part);
void run_irradiance_stage(StageContext& context, StagePart& part);

}  // namespace hairbake
