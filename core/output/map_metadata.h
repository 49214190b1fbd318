// The text attributes of irradiance map files.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/result/map_set.h"

namespace hairbake {

/// Text attributes of a file, in order. Neither dates nor paths belong here: same request, same bytes.
using Metadata = std::vector<std::pair<std::string, std::string>>;

/// 17 significant digits at most: reading them gives the double back.
std::string number_text(double value);

/// hairbake:map, model, exponent, units and frame; `map` is "diffuse", "specular 3" ...
Metadata map_metadata(const MapSet& maps, const std::string& map);

}  // namespace hairbake
