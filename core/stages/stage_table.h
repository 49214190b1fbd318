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

/// Runs the stage, whose inputs have been read (BakeInputs::read_for).
/// Throws Error as bake().
StagePart run_stage(const Stage& stage, StageContext& context);

/// The code of one stage, in a file of its own (stage_table.cpp declares them all). `part` comes with stage and key;
/// the function fills in the rest.
using StageFunction = void(StageContext& context, StagePart& part);

}  // namespace hairbake
