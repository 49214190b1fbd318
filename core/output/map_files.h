// Irradiance maps as OpenEXR files, and the environment's coefficients as JSON.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/environment/color_primaries.h"
#include "core/output/file_sink.h"
#include "core/result/map_set.h"
#include "core/result/stage_part.h"

namespace hairbake {

/// diffuse.exr and specular_00.exr ... : the six faces in a vertical strip, n wide and 6n high; and the same as
/// *_latlong.exr, 4n x 2n in the gltf convention. `primaries` are the environment's: the files name them, and their
/// attribute `chromaticities` holds them where they are known.
/// Throws Error(cancelled) between files.
std::vector<WrittenFile> write_map_exr(const MapSet& maps, const NamedPrimaries& primaries,
                                       const std::filesystem::path& folder, Progress& progress);

/// environment_sh.json: real orthonormal coefficients of the environment's radiance, [bands^2][3].
WrittenFile write_environment_sh(const IrradianceFacts& facts, const NamedPrimaries& primaries,
                                 const std::filesystem::path& folder);

}  // namespace hairbake
