#include "core/environment/environment_filter.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/make_map.h"

namespace hairbake {
namespace {

using namespace testing;

/// Noise is the hardest picture: a step of 1e-7 of a texel changes it by at most 1e-6, wherever it is.
void expect_continuous(const EnvironmentMap& map, const Vec3d& direction, const Vec3d& step) {
    const Vec3d a = filtered_radiance(map, direction - step), b = filtered_radiance(map, direction + step);
    EXPECT_LT(length(a - b), 1e-5) << direction.x << ' ' << direction.y << ' ' << direction.z;
}

// Relatives of the block edge inside a map: the meridian where it begins, its poles, the edges of a cube's faces.
TEST(EnvironmentFilter, IsContinuousEverywhere) {
    for (const EnvironmentMap& map : {noise_map(16, 1), noise_map(16, 2, LatLong::openexr, {10, 20, 30}),
                                      noise_cube(8, 3), noise_cube(8, 4, {40, 50, 60})}) {
        Random random(5);
        for (int k = 0; k < 500; ++k) expect_continuous(map, random_direction(random), random_direction(random) * 1e-8);
        for (const double x : {0.0, 1.0, 7.5, 8.0, 15.99}) {
            const int rows = map.height;
            for (int row = 0; row < rows; ++row)
                expect_continuous(map, direction_of(map, {std::min<double>(x, map.width), double(row)}),
                                  {1e-8, 2e-8, -1e-8});
        }
    }
}

TEST(EnvironmentFilter, GivesTheTexelsAtTheirCentresAndAConstantEverywhere) {
    for (const EnvironmentMap& map : {noise_map(16, 1, LatLong::filament), noise_cube(8, 3, {1, 2, 3})})
        for (int y = 0; y < map.height; ++y)
            for (int x = 0; x < map.width; ++x) {
                const Vec3d found = filtered_radiance(map, direction_of(map, {x + 0.5, y + 0.5}));
                EXPECT_LT(length(found - Vec3d(map.pixels[static_cast<std::size_t>(y) * map.width + x])), 1e-6);
            }
    const EnvironmentMap constant = make_map(8, [](const Vec3d&) { return Vec3d(1, 2, 3); });
    Random random(7);
    for (int k = 0; k < 100; ++k)
        EXPECT_LT(length(filtered_radiance(constant, random_direction(random)) - Vec3d(1, 2, 3)), 1e-6);
}

}  // namespace
}  // namespace hairbake
