// Finds and repairs pixels whose radiance is negative, infinite or NaN.
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Checks every pixel of `map`, repairs it in place, and returns the counts and energies.
///   map       pixels in the file's own unit, before exposure and tint
///   policy    what to do with invalid pixels (environment_settings.h)
///   where     the file's name, for the error
/// A pixel counts once in every kind that it has; -infinity counts as infinite. energy_removed sums finite negative
/// values only. Deterministic for any thread count.
/// Throws Error(bad_input) for the first invalid pixel in row order: under reject always, under automatic when the
/// invalid share (below) is above 1 %. It names the pixel (place_of_texel), its channel, its value, the share and the
/// field environment_settings.invalid_radiance.
/// Throws Error(cancelled).
RadianceRepairs repair_radiance(EnvironmentMap& map, InvalidRadiance policy, const std::string& where,
                                const Progress& progress);

/// How much of the map was invalid: negative radiance as a share of the light, plus the share of the sphere that
/// infinite and NaN pixels cover. Infinite where negative radiance stands alone.
double invalid_share(const RadianceRepairs& repairs);

}  // namespace hairbake
