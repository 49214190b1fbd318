#include "core/environment/cube_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/assert.h"

namespace hairbake {
namespace {

double centre(int size, int index) { return (2 * index + 1) / double(size) - 1; }

int texel_coordinate(int size, double a) {
    return std::clamp(static_cast<int>(std::floor((a + 1) / 2 * size)), 0, size - 1);
}

// The texel across an edge: either the row or the column is outside the face, not both. A point a thousandth of a texel
// beyond the edge is in the neighbouring face, and is displaced along the edge by less than that.
std::size_t neighbour(int size, int face, int row, int column) {
    const double limit = 1 + 2e-3 / size;
    return cube_texel_of(size, cube_vector({face, std::clamp(centre(size, column), -limit, limit),
                                            std::clamp(centre(size, row), -limit, limit)}));
}

Vec3d texel_or_neighbour(const CubeTexels& texels, int size, int face, int row, int column) {
    const bool row_inside = row >= 0 && row < size, column_inside = column >= 0 && column < size;
    if (row_inside && column_inside) return Vec3d(texels[cube_texel_index(size, face, row, column)]);
    if (row_inside || column_inside) return Vec3d(texels[neighbour(size, face, row, column)]);
    const int r = std::clamp(row, 0, size - 1), c = std::clamp(column, 0, size - 1);
    return (Vec3d(texels[cube_texel_index(size, face, r, c)]) + Vec3d(texels[neighbour(size, face, row, c)]) +
            Vec3d(texels[neighbour(size, face, r, column)])) /
           3.0;
}

}  // namespace

std::string_view cube_face_name(int face) {
    constexpr std::array<std::string_view, cube_faces> names{"+X", "-X", "+Y", "-Y", "+Z", "-Z"};
    return names.at(face);
}

Vec3d cube_vector(CubePoint p) {
    switch (p.face) {
        case 0:
            return {1, -p.b, -p.a};
        case 1:
            return {-1, -p.b, p.a};
        case 2:
            return {p.a, 1, p.b};
        case 3:
            return {p.a, -1, -p.b};
        case 4:
            return {p.a, -p.b, 1};
        default:
            return {-p.a, -p.b, -1};
    }
}

Vec3d cube_direction(CubePoint point) { return normalized(cube_vector(point)); }

CubePoint cube_point(const Vec3d& d) {
    HAIRBAKE_ASSERT(dot(d, d) > 0);
    const Vec3d m{std::abs(d.x), std::abs(d.y), std::abs(d.z)};
    if (m.x >= m.y && m.x >= m.z)
        return d.x > 0 ? CubePoint{0, -d.z / m.x, -d.y / m.x} : CubePoint{1, d.z / m.x, -d.y / m.x};
    if (m.y >= m.z) return d.y > 0 ? CubePoint{2, d.x / m.y, d.z / m.y} : CubePoint{3, d.x / m.y, -d.z / m.y};
    return d.z > 0 ? CubePoint{4, d.x / m.z, -d.y / m.z} : CubePoint{5, -d.x / m.z, -d.y / m.z};
}

Vec3d cube_texel_direction(int size, int face, int row, int column) {
    return cube_direction({face, centre(size, column), centre(size, row)});
}

std::size_t cube_texel_of(int size, const Vec3d& direction) {
    const CubePoint p = cube_point(direction);
    return cube_texel_index(size, p.face, texel_coordinate(size, p.b), texel_coordinate(size, p.a));
}

std::size_t cube_antipode(int size, std::size_t texel) {
    HAIRBAKE_ASSERT(texel < std::size_t(cube_faces) * size * size);
    const int column = static_cast<int>(texel % size), row = static_cast<int>(texel / size % size);
    const int face = static_cast<int>(texel / size / size);
    // -(+X)(a, b) = (-1, b, a) = (-X)(a, -b), likewise Z; -(+Y)(a, b) = (-a, -1, -b) = (-Y)(-a, b).
    const bool about_y = face == 2 || face == 3;
    return cube_texel_index(size, face ^ 1, about_y ? row : size - 1 - row, about_y ? size - 1 - column : column);
}

std::vector<double> cube_texel_solid_angles(int size) {
    const auto corner = [size](int i, int j) {
        const double x = 2.0 * i / size - 1, y = 2.0 * j / size - 1;
        return std::atan2(x * y, std::sqrt(x * x + y * y + 1));
    };
    std::vector<double> angles;
    angles.reserve(std::size_t(size) * size);
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i)
            angles.push_back(corner(i + 1, j + 1) - corner(i, j + 1) - corner(i + 1, j) + corner(i, j));
    return angles;
}

Vec3d sample_cube(const CubeTexels& texels, int size, const Vec3d& direction) {
    const CubePoint p = cube_point(direction);
    const double x = (p.a + 1) / 2 * size - 0.5, y = (p.b + 1) / 2 * size - 0.5;
    const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
    const double fx = x - column, fy = y - row;
    const auto at = [&](int dy, int dx) { return texel_or_neighbour(texels, size, p.face, row + dy, column + dx); };
    return (at(0, 0) * (1 - fx) + at(0, 1) * fx) * (1 - fy) + (at(1, 0) * (1 - fx) + at(1, 1) * fx) * fy;
}

}  // namespace hairbake
