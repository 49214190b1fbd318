// Small occluders built in code.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "core/mesh/mesh_normals.h"
#include "core/mesh/triangle_mesh.h"

namespace hairbake::test_support {

/// A ball about `centre` of `rings` bands of latitude and twice as many of longitude, positions on the sphere.
inline TriangleMesh ball_mesh(const Vec3d& centre, double radius, int rings) {
    TriangleMesh mesh;
    const int columns = 2 * rings;
    const auto add = [&](double polar, double azimuth) {
        mesh.positions.emplace_back(
            centre +
            Vec3d(std::sin(polar) * std::sin(azimuth), std::cos(polar), std::sin(polar) * std::cos(azimuth)) * radius);
    };
    add(0, 0);
    for (int ring = 1; ring < rings; ++ring)
        for (int column = 0; column < columns; ++column)
            add(std::numbers::pi * ring / rings, 2 * std::numbers::pi * column / columns);
    add(std::numbers::pi, 0);
    const auto at = [&](int ring, int column) {
        return static_cast<std::uint32_t>(ring == 0       ? 0
                                          : ring == rings ? 1 + (rings - 1) * columns
                                                          : 1 + (ring - 1) * columns + column % columns);
    };
    for (int ring = 0; ring < rings; ++ring)
        for (int c = 0; c < columns; ++c) {
            if (ring + 1 < rings) mesh.triangles.push_back({at(ring, c), at(ring + 1, c), at(ring + 1, c + 1)});
            if (ring > 0) mesh.triangles.push_back({at(ring, c), at(ring + 1, c + 1), at(ring, c + 1)});
        }
    mesh.normals = normals_of_faces(mesh);
    return mesh;
}

/// A flat disc in the plane y = `height`, facing up: a fan of `sides` triangles.
inline TriangleMesh disc_mesh(double height, double radius, int sides) {
    TriangleMesh mesh;
    mesh.positions.emplace_back(0.0f, static_cast<float>(height), 0.0f);
    for (int k = 0; k < sides; ++k) {
        const double angle = 2 * std::numbers::pi * k / sides;
        mesh.positions.emplace_back(Vec3d(radius * std::sin(angle), height, radius * std::cos(angle)));
    }
    for (int k = 0; k < sides; ++k)
        mesh.triangles.push_back(
            {0, static_cast<std::uint32_t>(1 + k), static_cast<std::uint32_t>(1 + (k + 1) % sides)});
    mesh.normals = normals_of_faces(mesh);
    return mesh;
}

inline TriangleMesh turned_round(TriangleMesh mesh) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    mesh.normals = normals_of_faces(mesh);
    return mesh;
}

}  // namespace hairbake::test_support
