// The manifest's entries about each stage.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/request/request.h"
#include "core/result/stage_part.h"

namespace hairbake {

/// The manifest's top-level entries about this part: a block with the stage's name, and for the transmittance also
/// "error_bar".
nlohmann::ordered_json describe_part(const StagePart& part, const BakeRequest& request);

}  // namespace hairbake
