// Documents compiled into the daemon from config/.
#pragma once

#include <string_view>

namespace hairbake {

/// config/openapi.json. openapi() completes it.
std::string_view openapi_document();

}  // namespace hairbake
