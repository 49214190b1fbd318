// The contents of a mesh file before its polygons are cut into triangles. Private to core/mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// Polygons over shared positions, in the file's order.
struct PolygonMesh {
    std::vector<Vec3f> positions;        ///< finite, at most 1e18 in magnitude
    std::vector<Vec3f> normals;          ///< one for each position, of any length, (0, 0, 0) for none; or empty
    std::vector<std::uint32_t> corners;  ///< of all faces one after another; each is an index of `positions`
    std::vector<std::size_t> face_end;   ///< for each face, the place in `corners` behind its last one

    std::span<const std::uint32_t> face(std::size_t i) const {
        const std::size_t begin = i == 0 ? 0 : face_end[i - 1];
        return std::span(corners).subspan(begin, face_end[i] - begin);
    }
    void end_face() { face_end.push_back(corners.size()); }
};

/// A mesh file as its reader understood it.
struct PolygonFile {
    PolygonMesh mesh;
    std::string format;                 ///< as people write it: "OBJ", "PLY, ASCII"
    std::vector<std::string> warnings;  ///< each continues "the mesh: ..."
};

}  // namespace hairbake
