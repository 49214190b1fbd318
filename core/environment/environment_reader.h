// Reads an HDR environment: one picture, or six with the faces of a cube.
#pragma once

#include <filesystem>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Reads HDR, EXR, TIFF, PFM or PNG (8 and 16 bit integers are sRGB decoded and warned of). Alpha and further channels
/// are dropped with a warning, one channel is taken as grey. `path` is a file, a folder or a pattern
/// (environment_files.h); the pixels are a lat-long map or a cube in one of the layouts of cube_layout.h or as six
/// files. The layout `auto` tells which by the shape; map.layout says what was taken. A cube stays a cube. The declared
/// size is checked before memory is taken (environment_assembly.h). Throws Error(bad_input) with the file's name, where
/// in it, what was found and what is allowed.
EnvironmentMap read_environment(const std::filesystem::path& path, const EnvironmentSettings& settings,
                                Progress& progress);

}  // namespace hairbake
