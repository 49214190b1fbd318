// Reads the pixels of an image file with OpenImageIO, distrusting it.
#pragma once

#include <filesystem>
#include <functional>
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
    bool openexr_cube = false;  ///< EXR's envmap attribute says cube: OpenEXR's own orientation of the faces
    std::vector<std::string> warnings;
};

/// Judges a declared size before any memory is taken: returns what is wrong with it ("the size is ...; allowed is
/// ..."), empty if nothing.
using SizeCheck = std::function<std::string(int width, int height)>;

/// Reads an image in pieces of about a million pixels, between which `progress` is told and may cancel. The format is
/// told from the file's first bytes, not its name; the declared size is given to `check` and compared with the most
/// that a file of this length can hold before any memory is taken, and tiles too large to decode a row of them are
/// refused. `check` bounds the memory. Channels R, G, B are found by name (in any layer), otherwise the first three are
/// taken; one channel is grey. Throws Error(bad_input) with file, place, what was found and what is allowed;
/// Error(out_of_resources); Error(cancelled).
ImageFile read_image_file(const std::filesystem::path& file, const SizeCheck& check, Progress& progress);

}  // namespace hairbake
