// Reads the pixels of an image file with OpenImageIO, distrusting it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"

namespace hairbake {

/// Pixels as decoded: integers scaled to [0, 1] but not yet linearised.
struct ImageFile {
    int width = 0, height = 0;
    std::vector<Vec3f> pixels;  ///< [height * width], row 0 on top
    std::string format;         ///< "hdr", "openexr", "tiff", "pnm" (PFM), "png"
    std::string primaries;      ///< from the file's chromaticities, "unspecified" without
    bool integer = false;       ///< the file holds integers
    std::vector<std::string> warnings;
};

/// Reads a 2:1 image in pieces of about a million pixels, between which `progress` is told (stage
/// read_environment, 0 to 0.9) and may cancel. The format is told from the file's first bytes, not its name; the
/// declared size is checked against 16384 x 8192, the shape and, where compression has a known limit, the file's length
/// before any memory is taken. Channels R, G, B are found by name (in any layer), otherwise the first three are taken;
/// one channel is grey. Throws Error(bad_input) with file, place, what was found and what is allowed;
/// Error(out_of_resources); Error(cancelled).
ImageFile read_image_file(const std::filesystem::path& file, Progress& progress);

}  // namespace hairbake
