// The OpenAPI document that /openapi.json returns.
#pragma once

#include <string>

namespace hairbake {

/// config/openapi.json with the request's schema (config/request.schema.json) and the presets as examples.
std::string openapi();

}  // namespace hairbake
