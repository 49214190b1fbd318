// Irradiance maps over the strand tangent: one diffuse and M + 1 specular cube maps (Xing 2012, section 3).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/environment/cube_map.h"
#include "core/environment/directional_light.h"
#include "core/environment/environment_map.h"

namespace hairbake {

enum class IrradianceMethod {
    exact,  ///< every pixel, through flux-centroid lights (light_set.h) and tabulated kernels (kernel_sum.h)
    sh      ///< zonal convolution in spherical harmonics (sh_maps.h)
};

/// The request's `irradiance` block without the fields of EnvironmentSettings.
struct IrradianceSettings {
    std::string model = "kajiya-kay";
    int face_size = 16;      ///< texels per cube edge, 4 to 256
    int specular_maps = 33;  ///< M + 1, from 2 to 257; theta'_m = m pi / M
    double exponent = 64;    ///< Kajiya-Kay p, 0 to 4096
    IrradianceMethod method = IrradianceMethod::exact;
    std::optional<int> sh_bands_diffuse;  ///< 1 to 128 bands (l = 0 .. bands - 1); empty: auto from sh_error
    std::optional<int> sh_bands_specular;
    double sh_error = 0.01;                ///< target of auto: RMS over the largest value of all maps, (0, 1]
    bool clamp_negative = true;            ///< sh only: negative texels become 0, their mass is reported
    std::vector<DirectionalLight> lights;  ///< at most 64; both methods add them to the maps with the exact kernel
};

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
