// Makes an environment map from picture files: finds their layout, and puts the faces of a cube into one map.
#pragma once

#include <string>

#include "core/base/progress.h"
#include "core/environment/environment_files.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// The fault of a picture of this declared size as the layout `requested` (any but faces); empty where there is none.
/// Faults are the shape of no layout, the shape of another layout, and a size above the limits: lat-long maps up to
/// 16384 x 8192 pixels, faces up to 4096 x 4096 and 2^27 pixels in all.
std::string fault_of_size(EnvironmentLayout requested, int width, int height);

/// Reads the files and orders the pixels: as lat-long rows, or as cube texels in the orientation of cube_map.h. Sets
/// shape, size, pixels (integers decoded as sRGB), source_format, layout, primaries, low_dynamic_range
/// and warnings; latlong is openexr where an EXR file's envmap attribute says lat-long.
///   files      one picture, or six faces that are square, of one size and of one colour space
///   requested  the layout, or automatic
///   progress   reports 0 to 0.9
/// An EXR that calls itself a cube map (envmap attribute) has OpenEXR's own orientation of the faces. They are turned
/// to that of OpenGL, unless the layout vertical_strip is requested by name. Both are said in a warning. So is a cross
/// that was found by its shape and has a picture outside its faces. Every size is checked before memory is taken for
/// it.
/// Throws Error(bad_input) naming the file, what was found and what is allowed, Error(out_of_resources),
/// Error(cancelled).
EnvironmentMap assemble_environment(const EnvironmentFiles& files, EnvironmentLayout requested, Progress& progress);

/// Makes those checks of assemble_environment() that need only the files' headers: that they are there and can be read,
/// their layout, sizes and primaries.
/// Throws the same errors with the same words.
void check_pictures(const EnvironmentFiles& files, EnvironmentLayout requested);

}  // namespace hairbake
