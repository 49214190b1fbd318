// What the manifest says of each stage.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/request/request.h"
#include "core/result/stage_part.h"

namespace hairbake {

/// The manifest's top-level entries about this part: a block with the stage's name and, of the transmittance,
/// "error_bar".
nlohmann::ordered_json describe_part(const StagePart& part, const BakeRequest& request);

}  // namespace hairbake
