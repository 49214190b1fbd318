// Irradiance maps by zonal convolution in spherical harmonics.
#pragma once

#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"
#include "core/fiber/fiber_model.h"
#include "core/irradiance/irradiance_settings.h"
#include "core/irradiance/tangent_maps.h"

namespace hairbake {

/// Maps of the environment alone, and how exact they are.
struct ShMaps {
    TangentMaps maps;
    /// Sum of |negative| * texel solid angle over channels, before clamping: of the diffuse map, and of each specular
    /// map.
    double negative_mass_diffuse = 0;
    std::vector<double> negative_mass_specular;

    int bands_diffuse = 0, bands_specular = 0;  ///< kept
    /// Predicted RMS error of the lobe's maps, relative to the largest value of the maps of the same lobe.
    double predicted_error_diffuse = 0, predicted_error_specular = 0;

    /// The environment's coefficients in the world frame, [environment_bands^2].
    std::vector<Vec3d> environment;
    int environment_bands = 0;

    explicit ShMaps(TangentMaps baked) : maps(std::move(baked)) {}
};

/// Convolves the environment with the kernels of a zonal model.
///   map           the environment
///   settings      which maps, bands and the target error
///   kernels       of the fibre model
///   report_bands  fewest bands of ShMaps::environment; it holds as many as the maps use, up to 32
///
/// Every kernel is zonal about t, so map_lm = lambda_l * environment_lm (Funk-Hecke; the transfer matrix of Xing 2012,
/// equation 11, is diagonal; docs/math.md, "Spherical harmonics").
///
/// The error of keeping `bands` bands, as RMS over the sphere of tangents, a lobe's maps and the channels, is by
/// Parseval sqrt(1/(4 pi) * sum over l >= bands of lambda_l^2 * power_l), power_l = sum over m of c_lm^2. Bands that
/// were not projected count with the largest power that a non-negative environment of that flux can have, power_l <=
/// (2l + 1)/(4 pi) flux^2. A tenth is added, because maps hold samples of the sphere. The sum is divided by the largest
/// value of the lobe's maps with all projected bands. `auto` takes the fewest bands that predict at most sh_error,
/// separately for the diffuse and the specular maps, at most 128. Deterministic for any thread count.
/// Throws Error(cancelled).
ShMaps bake_sh_maps(const EnvironmentMap& map, const IrradianceSettings& settings, const ZonalKernels& kernels,
                    int report_bands, const Progress& progress);

}  // namespace hairbake
