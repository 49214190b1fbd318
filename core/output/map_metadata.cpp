#include "core/output/map_metadata.h"

#include <cstdio>

namespace hairbake {

std::string number_text(double value) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.17g", value);
    return buffer;
}

Metadata map_metadata(const MapSet& maps, const std::string& map) {
    return {{"hairbake:map", map},
            {"hairbake:model", maps.model},
            {"hairbake:exponent", number_text(maps.exponent)},
            {"hairbake:units", "radiance times steradian; Kd and Ks are not applied"},
            {"hairbake:frame", "right-handed, Y up; the texel's direction is the strand's tangent, root to tip"}};
}

}  // namespace hairbake
