// Normals of a mesh's positions from its triangles.
#pragma once

#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// One unit normal for each position: the sum of its triangles' normals, each weighted by the triangle's angle there.
/// So it does not depend on how flat faces are triangulated. (0, 1, 0) where no triangle gives one.
std::vector<Vec3f> normals_of_faces(const TriangleMesh& mesh);

}  // namespace hairbake
