// From picture files to an environment: which layout they have, and a cube's faces in one map.
#pragma once

#include <string>

#include "core/base/progress.h"
#include "core/environment/environment_files.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// What is wrong with a picture of this declared size as the layout `requested` (auto or any but faces): a shape of no
/// layout or of another one, or too large: lat-long maps up to 16384 x 8192, faces up to 4096 and 2^27 pixels in all.
/// Empty if nothing.
std::string fault_of_size(const std::string& requested, int width, int height);

/// Reads the files and puts the pixels where they belong: lat-long rows, or cube texels in the orientation of
/// cube_map.h (cube_layout.h says which pixel is which). Sets shape, size, pixels (integers decoded as sRGB),
/// source_format, layout, primaries, low_dynamic_range and warnings. Six faces must be square, of one size and of one
/// colour space. An EXR that calls itself a cube map (envmap attribute) has OpenEXR's own orientation of the faces and
/// is refused, unless the layout vertical_strip is asked for by name, which takes the faces as ours and warns.
/// Every size is checked before memory is taken for it. Throws Error(bad_input) naming the file, what was found and
/// what is allowed, Error(out_of_resources), Error(cancelled).
EnvironmentMap assemble_environment(const EnvironmentFiles& files, const std::string& requested, Progress& progress);

}  // namespace hairbake
