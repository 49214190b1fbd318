// Irradiance maps as .npy and OpenEXR files, and the environment's coefficients as JSON.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/irradiance/irradiance_maps.h"
#include "core/output/file_sink.h"

namespace hairbake {

/// diffuse.npy [6, n, n, 3] and specular.npy [M + 1, 6, n, n, 3]: face, row, column, RGB.
std::vector<WrittenFile> write_map_npy(const IrradianceMaps& maps, const std::filesystem::path& folder);

/// diffuse.exr and specular_00.exr ... : the six faces in a vertical strip, n wide and 6n high; and the same as
/// *_latlong.exr, 4n x 2n in the gltf convention. Throws Error(cancelled) between files.
std::vector<WrittenFile> write_map_exr(const IrradianceMaps& maps, const std::filesystem::path& folder,
                                       Progress& progress);

/// environment_sh.json: real orthonormal coefficients of the environment's radiance, [bands^2][3].
WrittenFile write_environment_sh(const IrradianceMaps& maps, const std::filesystem::path& folder);

}  // namespace hairbake
