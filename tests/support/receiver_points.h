// A receiver made of points.
#pragma once

#include <utility>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace hairbake::test_support {

/// Positions and normals; nothing reads a receiver's triangles.
inline TriangleMesh receiver_points(const std::vector<std::pair<Vec3d, Vec3d>>& points_and_normals) {
    TriangleMesh mesh;
    for (const auto& [point, normal] : points_and_normals) {
        mesh.positions.emplace_back(point);
        mesh.normals.emplace_back(normalized(normal));
    }
    return mesh;
}

/// A square of two triangles at height z, 2 * half wide about the z axis, seen from above.
inline TriangleMesh square(double z, double half) {
    TriangleMesh mesh = receiver_points({{{-half, -half, z}, {0, 0, 1}},
                                         {{half, -half, z}, {0, 0, 1}},
                                         {{half, half, z}, {0, 0, 1}},
                                         {{-half, half, z}, {0, 0, 1}}});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

}  // namespace hairbake::test_support
