// Reads an HDR environment map with OpenImageIO.
#pragma once

#include <filesystem>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Reads HDR, EXR, TIFF, PFM or PNG (8 and 16 bit integers are sRGB decoded and warned of). Alpha and further channels
/// are dropped with a warning, one channel is taken as grey. The declared size is checked against
/// 16384 x 8192 pixels before memory is taken. Throws Error(bad_input) with the file's name, where in it, what
/// was found and what is allowed.
EnvironmentMap read_environment(const std::filesystem::path& file, const EnvironmentSettings& settings,
                                Progress& progress);

}  // namespace hairbake
