// What happens to pixels that no light can have: negative, infinite, NaN.
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Checks every pixel of `map` under `policy` and fills map.repairs.
/// `reject`: the first invalid pixel in row order is an Error(bad_input) that begins with `where` (the file's name) and
/// names the pixel (place_of_texel), its channel and value and the field irradiance.invalid_radiance. `clamp`:
/// negative, -infinity and NaN become 0, +infinity becomes the largest finite value of the map; a pixel counts once in
/// every kind that it has (-infinity as infinite); energy_removed sums finite negative values only. Energies are in the
/// unit of the pixels as they are here: the file's own, before exposure and tint. Deterministic for any thread count.
/// Throws Error(cancelled).
void repair_radiance(EnvironmentMap& map, InvalidRadiance policy, const std::string& where, const Progress& progress);

}  // namespace hairbake
