// The head of the sample grooms as a triangle mesh.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// A closed triangle mesh in centimetres: every edge belongs to two triangles, which run counter-clockwise seen from
/// outside.
struct HeadMesh {
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;  ///< outward unit normals of the shape, one for each position
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The shape of head_shape.h cut into `rings` bands of latitude (4 to 2048) and twice as many of longitude. The
/// vertices lie on the shape; with the default the facets stay within 0.02 cm of it on the scalp.
/// Throws Error(usage) when `rings` is out of range.
HeadMesh make_head_mesh(int rings = 96);

/// Writes Wavefront OBJ (v, vn, f). Throws Error(out_of_resources) when the file cannot be written whole.
void write_obj(const HeadMesh& mesh, const std::filesystem::path& file);

}  // namespace hairbake
