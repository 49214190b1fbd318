// The transmittance stage by deep opacity maps: the published estimator, kept for comparison.
#pragma once

#include "core/base/progress.h"
#include "core/volume/transmittance.h"

namespace hairbake {

/// Transmittance of every vertex from one opacity map a direction (Xing 2012, section 4, with three layers; Yuksel and
/// Keyser 2008; spec, section 3b): T = exp(-Omega) with Omega from the map of opacity_map.h, and A, spherical
/// harmonics, bent cone and receiver from T as their definitions say. `settings.opacity_maps` gives layers, spacing and
/// resolution; a texel is never smaller than twice the 95th percentile of the widths, and a warning tells where that
/// decided. Directions run side by side, up to 16 and as many as 1 GiB of maps allows.
/// Deterministic bit for bit for any thread count. Throws Error(usage) naming the field for settings out of range and
/// for what the method has not: an occluder; Error(bad_input) for a size that no map can hold, Error(out_of_resources),
/// Error(cancelled).
Transmittance bake_transmittance_opacity_maps(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                              Progress& progress);

}  // namespace hairbake
