// The transmittance stage by deep opacity maps: the published estimator, for comparison.
#pragma once

#include "core/base/progress.h"
#include "core/volume/transmittance.h"

namespace hairbake {

/// Transmittance of every vertex from one opacity map for each direction (Xing 2012, section 4, with three layers;
/// Yuksel and Keyser 2008; docs/math.md, "Opacity maps"). T = exp(-Omega) with Omega from OpacityMap. A, spherical
/// harmonics, bent cone and receiver follow from T by their definitions.
///
/// scene:    must have no occluder; keep_density is not read
/// settings: opacity_maps gives layers, spacing and resolution. A texel is at least twice the 95th percentile of the
///           widths; a warning says so where that is more than the resolution asks for.
///
/// Up to 16 directions run at the same time, or as many as 1 GiB of maps allows. The same bits for any thread count.
/// Throws Error(usage) with the field for settings out of range and for an occluder.
/// Throws Error(bad_input) for a size that no map can hold.
/// Throws Error(out_of_resources), Error(cancelled).
Transmittance bake_transmittance_opacity_maps(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                              Progress& progress);

}  // namespace hairbake
