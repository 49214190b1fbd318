// Small pictures of inputs.
#pragma once

#include <filesystem>

#include "core/base/progress.h"

namespace hairbake {

/// 256 x 256 PNG of the model seen from +Z, strands dark at the root and light at the tip.
void write_model_thumbnail(const std::filesystem::path& file, const std::filesystem::path& png);

/// 256 x 128 PNG of the panorama as the file has it, exposed like the preview's maps.
void write_environment_thumbnail(const std::filesystem::path& file, const std::filesystem::path& png,
                                 Progress& progress);

}  // namespace hairbake
