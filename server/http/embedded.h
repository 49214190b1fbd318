// Documents compiled into the daemon from config/.
#pragma once

#include <string_view>

namespace hairbake {

/// config/openapi.json, where components.schemas.BakeRequest is left to be filled in.
std::string_view openapi_document();

}  // namespace hairbake
