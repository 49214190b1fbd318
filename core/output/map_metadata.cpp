#include "core/output/map_metadata.h"

#include <cstdio>

namespace hairbake {

std::string number_text(double value) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.17g", value);
    return buffer;
}

Metadata map_metadata(const MapSet& maps, const std::string& map) {
    Metadata metadata{{"hairbake:map", map}, {"hairbake:model", maps.model}};
    for (const auto& [name, value] : maps.parameters) metadata.emplace_back("hairbake:" + name, number_text(value));
    metadata.emplace_back("hairbake:units", "radiance times steradian; Kd and Ks are not applied");
    metadata.emplace_back("hairbake:frame",
                          "right-handed, Y up; the texel's direction is the strand's tangent, root to tip");
    return metadata;
}

}  // namespace hairbake
