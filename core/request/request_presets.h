// The presets and the request's JSON schema, compiled into the program from config/.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/request/request.h"

namespace hairbake {

struct Preset {
    std::string_view name;  ///< "draft", "final", "paper", "v1"
    std::string_view json;  ///< the file: {"description": text, "request": fields that differ from the defaults}
};

/// The name that stands for the defaults in apply_preset(), where no preset's fields are taken.
inline constexpr std::string_view default_preset = "default";

/// All presets, in the order in which a person should meet them.
std::span<const Preset> presets();

/// The purpose of the preset, in one sentence.
std::string preset_description(const Preset& preset);

/// Takes the preset's fields over into `request`; those of default_preset are none.
/// Throws Error(usage) naming the presets there are.
void apply_preset(BakeRequest& request, std::string_view name);

/// config/request.schema.json (JSON Schema draft-07): the one schema of command line, service and OpenAPI document.
std::string_view request_schema();

}  // namespace hairbake
