// Irradiance maps over the strand tangent: one diffuse and M + 1 specular cube maps (Xing 2012, section 3).
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/environment/cube_map.h"
#include "core/environment/environment_map.h"
#include "core/irradiance/irradiance_settings.h"

namespace hairbake {

struct MapStatistics {
    Vec3d mean;  ///< weighted by texel solid angle
    Vec3f minimum, maximum;
    double clamped_negative_mass = 0;  ///< sum of |negative| * texel solid angle over channels, before clamping and
                                       ///< before lights are added
};

/// Everything the irradiance stage gives. Values are irradiance-like: radiance times steradian, Kd and Ks not applied.
struct IrradianceMaps {
    int face_size = 0;
    double exponent = 0;
    CubeTexels diffuse;                ///< D(t)
    std::vector<CubeTexels> specular;  ///< S_m(t), m = 0 .. M
    MapStatistics diffuse_statistics;
    std::vector<MapStatistics> specular_statistics;

    /// Real SH coefficients of the environment alone (without `lights`, which no few bands can hold) in the world
    /// frame, [bands * bands] in the order l*l + l + m of spec section 0. `exact` gives 8 bands, which keeps it cheap;
    /// `sh` as many as it used, 8 to 32.
    std::vector<Vec3d> environment_sh;
    int environment_sh_bands = 0;

    /// Bound for |linear interpolation between neighbouring theta' - truth| at any t and theta', per channel, in
    /// the unit of the maps and over the largest value of all maps (interpolation_bound.h says how). `sh` gathers the
    /// environment more coarsely for it, so its bound is a little larger.
    Vec3d interpolation_bound;
    double interpolation_bound_relative = 0;

    /// sh only: bands used and predicted truncation error (RMS over the largest value of all maps before `lights`
    /// are added, which have no such error; sh_maps.h says how). Zero for exact.
    int sh_bands_diffuse = 0, sh_bands_specular = 0;
    double predicted_error_diffuse = 0, predicted_error_specular = 0;

    std::vector<std::string> warnings;
};

/// Resolution of the light set (light_set.h) that the exact maps sum over: cells scale with the lobe's width, 1 /
/// sqrt(p); 64 at p = 64 and below.
int light_resolution(double exponent);

/// Checks every field. Throws Error(usage) naming the first one out of range.
void validate(const IrradianceSettings& settings);

/// The irradiance stage. Reads nothing but its arguments; the same arguments give the same bytes for any thread count.
/// Throws Error(usage) naming the field for a value out of range, Error(bad_input) for an environment whose pixels were
/// not repaired (negative, infinite, NaN), Error(cancelled).
IrradianceMaps bake_irradiance(const EnvironmentMap& environment, const IrradianceSettings& settings,
                               Progress& progress);

}  // namespace hairbake
