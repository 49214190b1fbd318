#include "core/output/map_metadata.h"

#include <algorithm>
#include <cstdio>

namespace hairbake {

std::string number_text(double value) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.17g", value);
    return buffer;
}

double theta_prime_degrees(const IrradianceMaps& maps, std::size_t m) {
    return 180.0 * static_cast<double>(m) / static_cast<double>(maps.specular.size() - 1);
}

std::string specular_name(const IrradianceMaps& maps, std::size_t m) {
    const std::string last = std::to_string(maps.specular.size() - 1);
    std::string number = std::to_string(m);
    number.insert(0, std::max<std::size_t>(2, last.size()) - number.size(), '0');
    return "specular_" + number;
}

Metadata map_metadata(const IrradianceMaps& maps, const std::string& map) {
    return {{"hairbake:map", map},
            {"hairbake:model", "kajiya-kay"},
            {"hairbake:exponent", number_text(maps.exponent)},
            {"hairbake:units", "radiance times steradian; Kd and Ks are not applied"},
            {"hairbake:frame", "right-handed, Y up; the texel's direction is the strand's tangent, root to tip"}};
}

}  // namespace hairbake
