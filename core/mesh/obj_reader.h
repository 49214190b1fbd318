// Reads Wavefront OBJ files. Private to core/mesh.
#pragma once

#include "core/mesh/mesh_reader.h"

namespace hairbake {

/// Takes v, vn and f lines of every group; no other file is opened, whatever `mtllib` says.
/// - positions[i] is the file's i-th `v` line, whether or not a face uses it.
/// - The normal of a position is the file's where all its corners name the same `vn`. Faces of a file without any `vn`
///   may name normals; these are ignored, with a warning.
///
/// The parser is our own. tinyobjloader silently reads "nan" and words as 0 and wraps indices at 2^32 (4294967297 is
/// position 1), and "1e2147483649" makes it overflow a signed integer.
extern const MeshReader obj_reader;

}  // namespace hairbake
