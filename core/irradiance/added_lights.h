// The request's directional lights: added to the maps that the environment gave, without quadrature or projection.
#pragma once

#include <span>

#include "core/base/progress.h"
#include "core/environment/directional_light.h"
#include "core/environment/light_set.h"
#include "core/irradiance/irradiance_maps.h"

namespace hairbake {

/// Adds to every texel t of `maps`, for each light of irradiance E at the angle theta to t, the kernels of
/// core/fiber/kajiya_kay.h: D += E sin(theta), S_m += E max(0, cos(pi - theta - theta'_m))^p. Sums over the lights in
/// double; D(-t) = D(t) and S_m(-t) = S_M-m(t) hold bit for bit in what is added. Without lights no bit changes.
/// Deterministic for any thread count. Throws Error(cancelled).
void add_directional_lights(std::span<const DirectionalLight> lights, const Progress& progress, IrradianceMaps& maps);

/// `lights` followed by the directional ones, for the bound of interpolation. Radius and total flux follow.
LightSet with_directional_lights(LightSet lights, std::span<const DirectionalLight> added);

}  // namespace hairbake
