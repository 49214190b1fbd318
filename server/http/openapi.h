// The API's description, as /openapi.json gives it.
#pragma once

#include <string>

namespace hairbake {

/// config/openapi.json with the request's schema (config/request.schema.json) and the presets, as examples, in it.
std::string openapi();

}  // namespace hairbake
