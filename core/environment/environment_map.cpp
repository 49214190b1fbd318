#include "core/environment/environment_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/assert.h"
#include "core/environment/cube_map.h"
#include "core/environment/latlong.h"

namespace hairbake {

using std::numbers::pi;

namespace {

Matrix3 multiply(const Matrix3& a, const Matrix3& b) {
    return {transform_back(b, a[0]), transform_back(b, a[1]), transform_back(b, a[2])};
}

// Rows: the polar frame's coordinates that give world X, Y and Z.
Matrix3 convention_matrix(LatLong convention) {
    const Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    HAIRBAKE_ASSERT(convention != LatLong::automatic);
    if (convention == LatLong::filament) return {y, z, x};
    if (convention == LatLong::openexr) return {-y, z, x};
    return {x, z, y};
}

}  // namespace

Matrix3 rotation_matrix(const std::array<double, 3>& rotation_deg) {
    std::array<double, 3> c{}, s{};
    for (int axis = 0; axis < 3; ++axis) {
        c[axis] = std::cos(rotation_deg[axis] * pi / 180);
        s[axis] = std::sin(rotation_deg[axis] * pi / 180);
    }
    const Matrix3 about_x{Vec3d{1, 0, 0}, Vec3d{0, c[0], -s[0]}, Vec3d{0, s[0], c[0]}};
    const Matrix3 about_y{Vec3d{c[1], 0, s[1]}, Vec3d{0, 1, 0}, Vec3d{-s[1], 0, c[1]}};
    const Matrix3 about_z{Vec3d{c[2], -s[2], 0}, Vec3d{s[2], c[2], 0}, Vec3d{0, 0, 1}};
    return multiply(about_z, multiply(about_y, about_x));
}

Matrix3 map_to_world(const EnvironmentMap& map) {
    if (map.shape == EnvironmentShape::cube) return map.rotation;
    return multiply(map.rotation, convention_matrix(map.latlong));
}

Vec3d direction_of(const EnvironmentMap& map, MapPoint point) {
    if (map.shape == EnvironmentShape::cube) {
        const int face = std::clamp(static_cast<int>(point.y / map.width), 0, cube_faces - 1);
        const double a = 2 * point.x / map.width - 1, b = 2 * (point.y - double(face) * map.width) / map.width - 1;
        return transform(map.rotation, cube_direction({face, a, b}));
    }
    const double theta = pi * point.y / map.height, phi = 2 * pi * point.x / map.width - pi;
    return transform(map_to_world(map),
                     {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
}

MapPoint point_of(const EnvironmentMap& map, const Vec3d& direction) {
    const Vec3d p = transform_back(map_to_world(map), direction);
    if (map.shape == EnvironmentShape::cube) {
        const CubePoint c = cube_point(p);
        return {(c.a + 1) / 2 * map.width, (c.face + (c.b + 1) / 2) * map.width};
    }
    const double theta = std::atan2(std::hypot(p.x, p.y), p.z), phi = std::atan2(p.y, p.x);
    return {(phi + pi) / (2 * pi) * map.width, theta / pi * map.height};
}

TexelSolidAngles texel_solid_angles(const EnvironmentMap& map) {
    if (map.shape == EnvironmentShape::cube)
        return {std::vector<double>(map.height, 1), cube_texel_solid_angles(map.width), map.width, map.width};
    return {latlong_rows(map.width, map.height).solid_angle, std::vector<double>(map.width, 1), 1, map.width};
}

std::string place_of_texel(const EnvironmentMap& map, std::size_t index) {
    const std::size_t x = index % map.width, y = index / map.width;
    const auto pixel = [&](std::size_t row) {
        return "pixel (" + std::to_string(x) + ", " + std::to_string(row) + ")";
    };
    if (map.shape == EnvironmentShape::latlong) return pixel(y);
    return pixel(y % map.width) + " of face " + std::string(cube_face_name(static_cast<int>(y / map.width)));
}

}  // namespace hairbake
