// Environment maps for tests, from functions of the direction.
#pragma once

#include <functional>

#include "core/base/random.h"
#include "core/environment/environment_map.h"
#include "core/environment/latlong.h"

namespace hairbake::testing {

/// A map of width x width/2 whose texels hold `radiance` at their centres' world directions.
inline EnvironmentMap make_map(int width, const std::function<Vec3d(const Vec3d&)>& radiance,
                               LatLong convention = LatLong::gltf, const std::array<double, 3>& rotation_deg = {}) {
    EnvironmentMap map;
    map.width = width;
    map.height = width / 2;
    map.latlong = convention;
    map.rotation = rotation_matrix(rotation_deg);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x)
            map.pixels.push_back(Vec3f(radiance(direction_of(map, {x + 0.5, y + 0.5}))));
    return map;
}

/// The same as a cube of size x size x 6.
inline EnvironmentMap make_cube(int size, const std::function<Vec3d(const Vec3d&)>& radiance,
                                const std::array<double, 3>& rotation_deg = {}) {
    EnvironmentMap map;
    map.shape = EnvironmentShape::cube;
    map.layout = EnvironmentLayout::faces;
    map.width = size;
    map.height = 6 * size;
    map.rotation = rotation_matrix(rotation_deg);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x)
            map.pixels.push_back(Vec3f(radiance(direction_of(map, {x + 0.5, y + 0.5}))));
    return map;
}

/// A black map with one texel whose flux (radiance times solid angle) is `flux`.
inline EnvironmentMap one_texel_sun(int width, int x, int y, const Vec3d& flux, LatLong convention = LatLong::gltf,
                                    const std::array<double, 3>& rotation_deg = {}) {
    EnvironmentMap map = make_map(
        width, [](const Vec3d&) { return Vec3d(); }, convention, rotation_deg);
    const double solid_angle = latlong_rows(map.width, map.height).solid_angle[y];
    map.pixels[std::size_t(y) * width + x] = Vec3f(flux / solid_angle);
    return map;
}

/// Every texel and channel independent and uniform in [0, 1).
inline EnvironmentMap noise_map(int width, std::uint64_t seed, LatLong convention = LatLong::gltf,
                                const std::array<double, 3>& rotation_deg = {}) {
    Random random(seed);
    return make_map(
        width,
        [&](const Vec3d&) {
            return Vec3d{random.next(), random.next(), random.next()};
        },
        convention, rotation_deg);
}

inline EnvironmentMap noise_cube(int size, std::uint64_t seed, const std::array<double, 3>& rotation_deg = {}) {
    Random random(seed);
    return make_cube(
        size,
        [&](const Vec3d&) {
            return Vec3d{random.next(), random.next(), random.next()};
        },
        rotation_deg);
}

/// Uniform on the sphere.
inline Vec3d random_direction(Random& random) {
    const double y = random.next(-1, 1), phi = random.next(-3.14159265358979, 3.14159265358979);
    const double radius = std::sqrt(1 - y * y);
    return {radius * std::cos(phi), y, radius * std::sin(phi)};
}

}  // namespace hairbake::testing
