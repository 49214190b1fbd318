// Finds and repairs pixels whose radiance is negative, infinite or NaN.
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Checks every pixel of `map`, repairs it in place, and returns the counts and energies.
///   map       pixels in the file's own unit, before exposure and tint
///   policy    reject: an invalid pixel is an error. clamp: negative, -infinity and NaN become 0, +infinity becomes the
///             largest finite value of the map
///   where     the file's name, for the error
/// A pixel counts once in every kind that it has; -infinity counts as infinite. energy_removed sums finite negative
/// values only. Deterministic for any thread count.
/// Throws Error(bad_input) for the first invalid pixel in row order under reject. It names the pixel (place_of_texel),
/// its channel, its value and the field environment_settings.invalid_radiance.
/// Throws Error(cancelled).
RadianceRepairs repair_radiance(EnvironmentMap& map, InvalidRadiance policy, const std::string& where,
                                const Progress& progress);

}  // namespace hairbake
