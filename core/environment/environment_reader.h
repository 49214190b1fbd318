// Reads an HDR environment: one picture, or six with the faces of a cube.
#pragma once

#include <filesystem>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Reads HDR, EXR, TIFF, PFM or PNG pictures. Integers of 8 and 16 bits are decoded as sRGB, with a warning. The layer
/// with the colours is taken (image_layers.h); alpha and further channels are dropped with a warning; one channel is
/// grey.
///   path      a file, a folder or a pattern (environment_files.h)
///   settings  layout, convention, rotation, exposure, tint, primaries, and how invalid radiance is treated
///   progress  reports 0 to 1
/// The pixels are a lat-long map, or a cube in one of the layouts of cube_layout.h or as six files. With the layout
/// automatic, the picture's shape decides; map.layout is the layout that was read. A cube stays a cube. The declared
/// size is checked before memory is taken (environment_assembly.h).
/// Throws Error(usage) naming the field out of range.
/// Throws Error(bad_input) with the file's name, the place in it, what was found and what is allowed.
/// Throws Error(out_of_resources), Error(cancelled).
EnvironmentMap read_environment(const std::filesystem::path& path, const EnvironmentSettings& settings,
                                Progress& progress);

/// Makes those checks of read_environment() that need only the headers of the files.
/// Throws the same errors with the same words.
void check_environment(const std::filesystem::path& path, const EnvironmentSettings& settings);

}  // namespace hairbake
