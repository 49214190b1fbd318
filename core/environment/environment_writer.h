// Writes an environment map as an image file.
#pragma once

#include <filesystem>

#include "core/environment/environment_map.h"

namespace hairbake {

/// Writes the pixels to a .hdr (RGBE) or .exr (32-bit float, ZIP) file. Convention and rotation are not applied. RGBE
/// keeps 8 bits of the largest channel: relative error up to 1 %.
/// Throws Error(usage) for another ending, Error(out_of_resources) when the file cannot be written; a partial file is
/// removed.
void write_environment(const EnvironmentMap& map, const std::filesystem::path& file);

}  // namespace hairbake
