#include "core/request/request_presets.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/request/request_json.h"

namespace hairbake {

std::string preset_description(const Preset& preset) {
    return nlohmann::json::parse(preset.json).at("description").get<std::string>();
}

void apply_preset(BakeRequest& request, std::string_view name) {
    if (name == default_preset) return;
    std::string names(default_preset);
    for (const Preset& preset : presets()) {
        if (preset.name == name) {
            const std::string fields = nlohmann::json::parse(preset.json).at("request").dump();
            merge_json(request, fields, "preset " + std::string(name));
            return;
        }
        names += ", " + std::string(preset.name);
    }
    throw Error(ErrorKind::usage, "there is no preset \"" + std::string(name) + "\"; allowed is one of " + names,
                "preset");
}

}  // namespace hairbake
