// The request's directional lights: added to the maps of the environment, without quadrature or projection.
#pragma once

#include <span>

#include "core/base/progress.h"
#include "core/environment/directional_light.h"
#include "core/environment/light_set.h"
#include "core/fiber/fiber_model.h"
#include "core/irradiance/irradiance_maps.h"

namespace hairbake {

/// Adds to every texel t of `maps`, for each light of irradiance E at the angle theta to t, the kernels of a zonal
/// model: D += E K_diffuse(theta), S_m += E K_specular(theta, theta'_m). Sums over the lights are in double. D(-t) =
/// D(t) and S_m(-t) = S_M-m(t) hold bit for bit in what is added. Without lights no bit changes. Deterministic for any
/// thread count.
/// Throws Error(cancelled).
void add_directional_lights(std::span<const DirectionalLight> lights, const ZonalKernels& kernels,
                            const Progress& progress, IrradianceMaps& maps);

/// `lights` followed by the directional ones. The radius stays, the total flux grows by theirs.
LightSet with_directional_lights(LightSet lights, std::span<const DirectionalLight> added);

}  // namespace hairbake
