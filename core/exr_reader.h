// Reads OpenEXR pictures.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

struct ExrPicture {
    int width = 0, height = 0;
    std::vector<Vec3f> pixels;  ///< rows from the top
};

/// The first three channels (R, G, B as hairbake writes them) of a flat OpenEXR file of up to 16384 x 16384 pixels that
/// fill its display window. The declared size is checked before memory is taken. Throws Error(bad_input) naming the
/// file, what was found and what is allowed; Error(out_of_resources).
ExrPicture read_exr(const std::filesystem::path& file);

}  // namespace hairbake
