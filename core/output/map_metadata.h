// What the files of irradiance maps are called and what they say about themselves.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/irradiance/irradiance_maps.h"

namespace hairbake {

/// Text attributes of a file, in order. Neither dates nor paths belong here: same request, same bytes.
using Metadata = std::vector<std::pair<std::string, std::string>>;

/// 17 significant digits at most: reading them gives the double back.
std::string number_text(double value);

/// theta'_m in degrees: m * 180 / M, for m = 0 .. M.
double theta_prime_degrees(const IrradianceMaps& maps, std::size_t m);

/// "specular_07", with as many digits as the last map needs, two at least.
std::string specular_name(const IrradianceMaps& maps, std::size_t m);

/// hairbake:map, model, exponent, units and frame; `map` is "diffuse", "specular 3" ...
Metadata map_metadata(const IrradianceMaps& maps, const std::string& map);

}  // namespace hairbake
