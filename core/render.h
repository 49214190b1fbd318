// The facade of pictures: renders a result folder, or hair and environment, to PNG and EXR.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/render/render_request.h"

namespace hairbake {

struct RenderedPicture {
    int width = 0, height = 0;
    Channel channel = Channel::beauty;
    std::vector<Vec3f> pixels;                                  ///< linear, rows from the top
    std::vector<std::pair<std::string, std::string>> metadata;  ///< for the EXR file; neither dates nor paths
    double render_seconds = 0;                                  ///< of the phase render alone
    std::vector<std::string> warnings;
};

/// Finds out what can be known before a picture is rendered: the request is valid, the headers of all inputs are right,
/// and the picture can be written to `files` (write_picture), which are none of the inputs. Reads no file to its end.
/// Throws the errors of render() and write_picture().
void check_render(const RenderRequest& request, const std::vector<std::filesystem::path>& files);

/// Validates, reads, bakes where needed and renders on `threads` threads (0: one per core). Reports the phases of
/// bake() and "render".
/// Throws Error(usage) naming the field.
/// Throws Error(bad_input) naming the file, also when a given file is not the one that the result was baked from.
/// Throws Error(out_of_resources), Error(cancelled).
RenderedPicture render(const RenderRequest& request, int threads, BakeProgress& progress);

/// Stops that bring the brighter tenth of the pixels that are not black to a bright but unclipped tone (output/tone.h);
/// 0 for channels that show no light.
double automatic_exposure(const RenderedPicture& picture);

/// Writes the picture by the name's ending, in lower or upper case: .exr linear float32, .png through the film curve at
/// `stops` (transmittance: 0 to 1 as 0 to 255; tangent: -1 to 1). The file appears whole.
/// Throws Error(usage) for another ending, and the errors of FileSink.
void write_picture(const RenderedPicture& picture, double stops, const std::filesystem::path& file);

}  // namespace hairbake
