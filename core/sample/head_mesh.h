// A triangle mesh of the head that the sample grooms grow on.
#pragma once

#include <filesystem>

#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// A closed mesh in centimetres: the shape of head_shape.h, with its normals, cut into `rings` bands of latitude (4 to
/// 2048) and twice as many of longitude. The vertices lie on the shape; with the default the facets stay within 0.02 cm
/// of it on the scalp.
/// Throws Error(usage) when `rings` is out of range.
TriangleMesh make_head_mesh(int rings = 96);

/// Writes Wavefront OBJ (v, vn, f).
/// Throws Error(out_of_resources) when the file cannot be written whole.
void write_obj(const TriangleMesh& mesh, const std::filesystem::path& file);

}  // namespace hairbake
