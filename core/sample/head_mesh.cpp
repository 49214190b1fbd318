#include "core/sample/head_mesh.h"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>
#include <system_error>

#include "core/base/error.h"
#include "core/sample/head_shape.h"

namespace hairbake {
namespace {

void add_vertex(TriangleMesh& mesh, const Vec3d& direction) {
    mesh.positions.emplace_back(direction * head_radius(direction));
    mesh.normals.emplace_back(head_normal(direction));
}

/// Two poles, and between them rings - 1 circles of `columns` vertices.
void add_vertices(TriangleMesh& mesh, int rings, int columns) {
    add_vertex(mesh, {0, 1, 0});
    for (int ring = 1; ring < rings; ++ring) {
        const double polar = std::numbers::pi * ring / rings;
        for (int column = 0; column < columns; ++column) {
            const double azimuth = 2 * std::numbers::pi * column / columns;
            add_vertex(mesh,
                       {std::sin(polar) * std::sin(azimuth), std::cos(polar), std::sin(polar) * std::cos(azimuth)});
        }
    }
    add_vertex(mesh, {0, -1, 0});
}

void add_triangles(TriangleMesh& mesh, int rings, int columns) {
    const auto vertex = [&](int ring, int column) {
        return static_cast<std::uint32_t>(1 + (ring - 1) * columns + column % columns);
    };
    const auto bottom = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    for (int column = 0; column < columns; ++column) {
        mesh.triangles.push_back({0, vertex(1, column), vertex(1, column + 1)});
        for (int ring = 1; ring + 1 < rings; ++ring) {
            const std::uint32_t a = vertex(ring, column), b = vertex(ring, column + 1);
            const std::uint32_t c = vertex(ring + 1, column), d = vertex(ring + 1, column + 1);
            mesh.triangles.push_back({a, c, d});
            mesh.triangles.push_back({a, d, b});
        }
        mesh.triangles.push_back({vertex(rings - 1, column), bottom, vertex(rings - 1, column + 1)});
    }
}

std::string line(const char* key, const Vec3f& v) {
    char text[100];
    std::snprintf(text, sizeof text, "%s %.7g %.7g %.7g\n", key, double{v.x}, double{v.y}, double{v.z});
    return text;
}

}  // namespace

TriangleMesh make_head_mesh(int rings) {
    if (rings < 4 || rings > 2048)
        throw Error(ErrorKind::usage, "rings is " + std::to_string(rings) + "; allowed are 4 to 2048", "rings");
    TriangleMesh mesh;
    add_vertices(mesh, rings, 2 * rings);
    add_triangles(mesh, rings, 2 * rings);
    return mesh;
}

void write_obj(const TriangleMesh& mesh, const std::filesystem::path& file) {
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    stream << "# hairbake sample head, unit cm, Y up, face towards +Z\n";
    for (const Vec3f& p : mesh.positions) stream << line("v", p);
    for (const Vec3f& n : mesh.normals) stream << line("vn", n);
    for (const auto& t : mesh.triangles) {
        stream << 'f';
        for (const std::uint32_t i : t) stream << ' ' << i + 1 << "//" << i + 1;
        stream << '\n';
    }
    stream.close();
    if (!stream)
        throw Error(ErrorKind::out_of_resources,
                    file.string() + ": could not be written whole: " + std::generic_category().message(errno));
}

}  // namespace hairbake
