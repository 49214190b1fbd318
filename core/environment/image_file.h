// Reads the pixels of an image file with OpenImageIO. The file is not trusted: sizes are checked before memory is
// taken.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/environment/color_primaries.h"

namespace hairbake {

/// Meaning of EXR's attribute `envmap`.
enum class OpenExrEnvironment { none, latlong, cube };

/// Pixels as decoded: integers scaled to [0, 1] but not yet linearised.
struct ImageFile {
    int width = 0, height = 0;
    std::vector<Vec3f> pixels;                     ///< [height * width], row 0 on top; none from read_image_facts()
    std::string format;                            ///< "hdr", "openexr", "tiff", "pnm" (PFM), "png"
    std::optional<Chromaticities> chromaticities;  ///< that the file states
    bool integer = false;                          ///< the file holds integers
    OpenExrEnvironment envmap = OpenExrEnvironment::none;
    std::vector<std::string> warnings;
};

/// Checks a declared size before any memory is taken: returns its fault ("the size is ...; allowed is ..."), empty
/// where there is none.
using SizeCheck = std::function<std::string(int width, int height)>;

/// Reads an image.
///   file      its format is recognised by its first bytes, not by its name
///   check     refuses declared sizes, and thereby bounds the memory
///   progress  reports 0 to 1; a cancellation is noticed after about a million pixels
/// Before any memory is taken, the declared size is also compared with the largest that a file of this length can hold,
/// and tiles are refused when a row of them is too large to decode. The layer with the colours is found by its name
/// (image_layers.h). An EXR picture is its display window: pixels outside its data window are black, pixels beyond the
/// display window are not used. Radiance pictures are read in any axis order, and their pixels are divided by the
/// header's exposure and colour correction.
/// Throws Error(bad_input) with the file, the place, what was found and what is allowed.
/// Throws Error(out_of_resources), Error(cancelled).
ImageFile read_image_file(const std::filesystem::path& file, const SizeCheck& check, Progress& progress);

/// The facts of an image without its pixels, from the header alone. It makes all checks that read_image_file() makes
/// before it decodes pixels.
/// Throws the same errors with the same words.
ImageFile read_image_facts(const std::filesystem::path& file, const SizeCheck& check);

}  // namespace hairbake
