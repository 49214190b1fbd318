// Irradiance maps by zonal convolution in spherical harmonics.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"
#include "core/irradiance/irradiance_maps.h"

namespace hairbake {

/// Fills diffuse, specular, their clamped_negative_mass, the bands used, the predicted errors and the environment's
/// coefficients (world, as many bands as used, but `report_bands` to 32) of `maps`, whose face_size and exponent are
/// set.
///
/// Every Kajiya-Kay kernel is zonal about t, so map_lm = lambda_l * environment_lm (Funk-Hecke; the transfer matrix of
/// Xing 2012, equation 11, is diagonal; spec, section 4).
///
/// The error of keeping `bands` bands, as RMS over the sphere of tangents, the maps and the channels, is by Parseval
/// sqrt(1/(4 pi) * sum over l >= bands of lambda_l^2 * power_l), power_l = sum over m of c_lm^2. Bands that were not
/// projected enter with the most that a non-negative environment of that flux can have, power_l <= (2l + 1)/(4 pi)
/// flux^2. A tenth is added, because maps hold samples of the sphere. It is divided by the largest value of all maps.
/// `auto` takes the fewest bands that predict at most sh_error, separately for the diffuse and the specular maps, at
/// most 128. Deterministic for any thread count. Throws Error(cancelled).
void bake_sh_maps(const EnvironmentMap& map, const IrradianceSettings& settings, int report_bands,
                  const Progress& progress, IrradianceMaps& maps);

}  // namespace hairbake
