// Irradiance maps over the strand tangent: one diffuse and M + 1 specular cube maps (Xing 2012, section 3).
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/environment/cube_map.h"
#include "core/environment/environment_map.h"
#include "core/fiber/fiber_settings.h"
#include "core/irradiance/irradiance_settings.h"

namespace hairbake {

struct MapStatistics {
    Vec3d mean;  ///< weighted by texel solid angle
    Vec3f minimum, maximum;
    double clamped_negative_mass = 0;  ///< sum of |negative| * texel solid angle over channels, before clamping and
                                       ///< before lights are added
};

/// The result of the irradiance stage. Values are radiance times steradian; Kd and Ks are not applied.
struct IrradianceMaps {
    int face_size = 0;
    double exponent = 0;               ///< of the Kajiya-Kay model, the only one that has maps
    CubeTexels diffuse;                ///< D(t)
    std::vector<CubeTexels> specular;  ///< S_m(t), m = 0 .. M
    MapStatistics diffuse_statistics;
    std::vector<MapStatistics> specular_statistics;

    /// Real SH coefficients of the environment alone (without `lights`, which would need many bands) in the world
    /// frame, [bands * bands] in the order l*l + l + m. `exact` gives 8 bands, which are cheap; `sh` gives as many as
    /// it used, 8 to 32.
    std::vector<Vec3d> environment_sh;
    int environment_sh_bands = 0;

    /// Bound for |linear interpolation between neighbouring theta' - truth| at any t and theta': per channel in the
    /// unit of the maps, and relative to the largest value of the specular maps (interpolation_bound.h). `sh` gathers
    /// the environment into fewer lights for it, so its bound is a little larger.
    Vec3d interpolation_bound;
    double interpolation_bound_relative = 0;

    /// sh only: bands used, and the predicted truncation error. The error is an RMS, relative to the largest value of
    /// the lobe's own maps before `lights` are added; lights have no such error (sh_maps.h). Zero for exact.
    int sh_bands_diffuse = 0, sh_bands_specular = 0;
    double predicted_error_diffuse = 0, predicted_error_specular = 0;

    std::vector<std::string> warnings;
};

/// Resolution of the light set (light_set.h) that the exact maps and the render modes sum over. Cells scale with the
/// lobe's width, 1 / sqrt(sharpness): 64 at a sharpness (fiber_model.h) of 64 and below, at most 512.
int light_resolution(double sharpness);

/// Checks every field.
/// Throws Error(usage) naming the first one out of range.
void validate(const IrradianceSettings& settings);

/// The irradiance stage: the maps of one environment for one fibre model.
///   environment  repaired radiance
///   settings     which maps, and the method
///   fiber        the model; it must have zonal kernels (fiber_model.h)
///   progress     reports 0 to 1
/// The same arguments give the same bytes for any thread count.
/// Throws Error(usage) naming the field for a value out of range or a model that has no maps.
/// Throws Error(bad_input) for an environment whose pixels were not repaired (negative, infinite, NaN).
/// Throws Error(cancelled).
IrradianceMaps bake_irradiance(const EnvironmentMap& environment, const IrradianceSettings& settings,
                               const FiberSettings& fiber, Progress& progress);

}  // namespace hairbake
