#include "core/mesh/mesh_normals.h"

#include <cmath>

namespace hairbake {

std::vector<Vec3f> normals_of_faces(const TriangleMesh& mesh) {
    std::vector<Vec3d> sums(mesh.positions.size());
    for (const auto& triangle : mesh.triangles) {
        const Vec3d p[3] = {Vec3d(mesh.positions[triangle[0]]), Vec3d(mesh.positions[triangle[1]]),
                            Vec3d(mesh.positions[triangle[2]])};
        const Vec3d across = cross(p[1] - p[0], p[2] - p[0]);
        const double twice_area = length(across);
        if (!(twice_area > 0)) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const double cosine_part = dot(p[(c + 1) % 3] - p[c], p[(c + 2) % 3] - p[c]);
            sums[triangle[c]] += across * (std::atan2(twice_area, cosine_part) / twice_area);
        }
    }
    std::vector<Vec3f> normals(sums.size(), Vec3f(0, 1, 0));
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double size = length(sums[i]);
        if (size > 1e-12) normals[i] = Vec3f(sums[i] / size);  // the weights are angles: a smaller sum is rounding
    }
    return normals;
}

}  // namespace hairbake
