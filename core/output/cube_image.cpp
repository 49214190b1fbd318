#include "core/output/cube_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hairbake {
namespace {

/// The texel (column i, row j) of a face, or, when it lies over an edge, the one there that is seen in its direction.
const Vec3f& texel(const CubeTexels& cube, int n, int face, int i, int j) {
    if (i < 0 || j < 0 || i >= n || j >= n) {
        const CubePoint there =
            cube_point(normalized(cube_direction({face, 2 * (i + 0.5) / n - 1, 2 * (j + 0.5) / n - 1})));
        face = there.face;
        i = std::clamp(static_cast<int>((there.a + 1) / 2 * n), 0, n - 1);
        j = std::clamp(static_cast<int>((there.b + 1) / 2 * n), 0, n - 1);
    }
    return cube[(static_cast<std::size_t>(face) * n + j) * n + i];
}

}  // namespace

CubePoint cube_point(const Vec3d& d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    if (x >= y && x >= z) return d.x > 0 ? CubePoint{0, -d.z / x, -d.y / x} : CubePoint{1, d.z / x, -d.y / x};
    if (y >= z) return d.y > 0 ? CubePoint{2, d.x / y, d.z / y} : CubePoint{3, d.x / y, -d.z / y};
    return d.z > 0 ? CubePoint{4, d.x / z, -d.y / z} : CubePoint{5, -d.x / z, -d.y / z};
}

Vec3d cube_direction(const CubePoint& point) {
    const double a = point.a, b = point.b;
    switch (point.face) {
        case 0:
            return {1, -b, -a};
        case 1:
            return {-1, -b, a};
        case 2:
            return {a, 1, b};
        case 3:
            return {a, -1, -b};
        case 4:
            return {a, -b, 1};
        default:
            return {-a, -b, -1};
    }
}

Vec3f look_up(const CubeTexels& cube, int n, const Vec3d& direction) {
    const CubePoint point = cube_point(direction);
    const double x = (point.a + 1) / 2 * n - 0.5, y = (point.b + 1) / 2 * n - 0.5;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    const float fx = static_cast<float>(x - i), fy = static_cast<float>(y - j);
    const Vec3f top = texel(cube, n, point.face, i, j) * (1 - fx) + texel(cube, n, point.face, i + 1, j) * fx;
    const Vec3f low = texel(cube, n, point.face, i, j + 1) * (1 - fx) + texel(cube, n, point.face, i + 1, j + 1) * fx;
    return top * (1 - fy) + low * fy;
}

Vec3d latlong_direction(int row, int column, int width, int height) {
    const double theta = std::numbers::pi * (row + 0.5) / height;
    const double phi = 2 * std::numbers::pi * ((column + 0.5) / width - 0.5);
    return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

Picture to_latlong(const CubeTexels& cube, int face_size, int width) {
    Picture picture{width, width / 2, {}};
    picture.pixels.reserve(static_cast<std::size_t>(width) * picture.height);
    for (int row = 0; row < picture.height; ++row)
        for (int column = 0; column < width; ++column)
            picture.pixels.push_back(look_up(cube, face_size, latlong_direction(row, column, width, picture.height)));
    return picture;
}

}  // namespace hairbake
