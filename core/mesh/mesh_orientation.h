// Turns the triangles of a mesh so that they agree about the outside.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace hairbake {

struct MeshOrientation {
    std::vector<bool> turned;  ///< for each triangle
    std::uint64_t turned_triangles = 0;
    std::uint64_t unorientable_parts = 0;  ///< as a Moebius band; left as they are
};

/// Turns triangles of `mesh` (swaps their last two corners). A part is a set of triangles joined by edges that lie in
/// two triangles; positions with equal coordinates count as one. A part whose edges all lie in two triangles is closed.
/// - A closed part whose triangles disagree is made to agree, outward by its signed volume.
/// - A closed part that agrees but encloses a negative volume is turned, unless it lies inside another closed part: then
///   it is the wall of a hollow, and its outside is the hollow.
/// - An open part whose triangles disagree follows the larger area; of two equal ones, its first triangle.
/// - Every other part stays as it is.
/// Leaves `mesh.normals` alone.
MeshOrientation orient(TriangleMesh& mesh);

}  // namespace hairbake
