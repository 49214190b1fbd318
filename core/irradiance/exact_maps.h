// Irradiance maps by summing tabulated kernels over every light.
#pragma once

#include "core/base/progress.h"
#include "core/environment/light_set.h"
#include "core/fiber/fiber_model.h"
#include "core/irradiance/irradiance_settings.h"
#include "core/irradiance/tangent_maps.h"

namespace hairbake {

/// Maps of the environment alone, and the bound of interpolating between them with settings.lights included.
struct ExactMaps {
    TangentMaps maps;
    Vec3d interpolation_bound;
};

/// Sums the kernels over the lights for the tangents of the faces +X, +Y and +Z; the opposite tangents follow from
/// D(-t) = D(t) and S_m(-t) = S_M-m(t), which hold for models that are symmetric between root and tip.
///   lights     the environment (light_set.h)
///   settings   face_size, specular_maps, lights
///   model      symmetric between root and tip, with zonal kernels
/// Deterministic for any thread count.
/// Throws Error(cancelled).
ExactMaps bake_exact_maps(const LightSet& lights, const IrradianceSettings& settings, const FiberModel& model,
                          Progress& progress);

}  // namespace hairbake
