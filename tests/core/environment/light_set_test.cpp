#include "core/environment/light_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/parallel.h"
#include "core/environment/cube_map.h"
#include "core/environment/latlong.h"
#include "core/sample/sky_generator.h"
#include "tests/support/make_map.h"

namespace hairbake {
namespace {

using testing::make_map;
using testing::noise_map;
using testing::one_texel_sun;

TEST(LightSet, FluxAndFirstMomentAreKept) {
    Progress progress;
    const EnvironmentMap map = noise_map(256, 1, LatLong::openexr, {10, 20, 30});
    const LatLongRows rows = latlong_rows(map.width, map.height);
    Vec3d flux, moment;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const Vec3d texel = Vec3d(map.pixels[std::size_t(y) * map.width + x]) * rows.solid_angle[y];
            flux += texel;
            moment += direction_of(map, {x + 0.5, y + 0.5}) * (texel.x + texel.y + texel.z);
        }
    const LightSet lights = make_light_set(map, 32, progress);
    EXPECT_LT(length(lights.total - flux), 1e-11);  // 32,768 double additions
    Vec3d light_moment;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const float* f = &lights.flux[4 * i];
        light_moment += Vec3d{lights.x[i], lights.y[i], lights.z[i]} * double(f[0] + f[1] + f[2]);
    }
    // A light sits on the sphere, the moment of its cell is shorter by spread^2 / 2: at most radius^2 / 2 of the flux.
    EXPECT_LT(length(light_moment - moment), 0.5 * lights.radius * lights.radius * (flux.x + flux.y + flux.z));
}

TEST(LightSet, ACubesFluxAndFirstMomentAreKept) {
    // 16: a light for every texel; 65: cells at the edges of a face hold several texels, others none; 200: all several.
    Progress progress;
    for (const int size : {1, 16, 65, 200}) {
        const EnvironmentMap map = testing::noise_cube(size, 1, {10, 20, 30});
        const TexelSolidAngles omega = texel_solid_angles(map);
        Vec3d flux, moment;
        for (int y = 0; y < map.height; ++y)
            for (int x = 0; x < map.width; ++x) {
                const Vec3d texel = Vec3d(map.pixels[std::size_t(y) * map.width + x]) * omega.at(x, y);
                flux += texel;
                moment += direction_of(map, {x + 0.5, y + 0.5}) * (texel.x + texel.y + texel.z);
            }
        const LightSet lights = make_light_set(map, 64, progress);
        EXPECT_TRUE(size > 64 || lights.size() == map.pixels.size());
        EXPECT_LE(lights.size(), 6u * 64 * 64);
        EXPECT_LT(length(lights.total - flux), 1e-11);
        Vec3d light_moment;
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const float* f = &lights.flux[4 * i];
            light_moment += Vec3d{lights.x[i], lights.y[i], lights.z[i]} * double(f[0] + f[1] + f[2]);
        }
        // As above; every texel of its own: single precision of the lights.
        const double spread = size <= 64 ? 0 : 0.5 * lights.radius * lights.radius;
        EXPECT_LT(length(light_moment - moment), (spread + 1e-6) * (flux.x + flux.y + flux.z)) << size;
    }
}

TEST(LightSet, NoTexelOfACubeIsFurtherFromItsLightThanTheRadius) {
    // One lit texel beside a brighter one: where they share a cell the light lies between them. With a whole cell lit
    // at one texel after the other, the light of the pair stays within the radius of both.
    Progress progress;
    const int size = 130;
    EnvironmentMap map = testing::make_cube(size, [](const Vec3d&) { return Vec3d(); });
    const double radius = make_light_set(map, 64, progress).radius;
    // Texels are 2 / size wide. Cells: at a face's middle 2 x 2, 2.8 diagonally; in its corners up to 4 x 4, seen from
    // sqrt(2.9) away: 3.3.
    EXPECT_LT(radius, 3.5 * 2.0 / size);
    for (int x = 0; x + 1 < size; x += 3) {
        const std::size_t index = cube_texel_index(size, 2, x, x);
        map.pixels[index] = Vec3f(1);
        map.pixels[index + 1] = Vec3f(3);
        const LightSet lights = make_light_set(map, 64, progress);
        for (int k = 0; k < 2; ++k) {
            const Vec3d texel = direction_of(map, {x + k + 0.5, 2 * size + x + 0.5});
            double nearest = 10;
            for (std::size_t i = 0; i < lights.size(); ++i)
                nearest = std::min(nearest, length(Vec3d{lights.x[i], lights.y[i], lights.z[i]} - texel));
            EXPECT_LE(nearest, radius);
        }
        map.pixels[index] = map.pixels[index + 1] = Vec3f(0);
    }
}

TEST(LightSet, ASunKeepsItsExactPlace) {
    Progress progress;
    for (const LatLong convention : {LatLong::gltf, LatLong::filament, LatLong::openexr}) {
        const EnvironmentMap map = one_texel_sun(1024, 700, 100, {3, 2, 1}, convention, {40, 50, 60});
        const LightSet lights = make_light_set(map, 64, progress);
        ASSERT_EQ(lights.size(), 1u);
        const Vec3d expected = direction_of(map, {700.5, 100.5});
        // Rounding to single precision.
        EXPECT_LT(length(Vec3d{lights.x[0], lights.y[0], lights.z[0]} - expected), 2e-7);
        EXPECT_NEAR(lights.flux[0], 3, 1e-6);
        EXPECT_NEAR(lights.flux[1], 2, 1e-6);
        EXPECT_NEAR(lights.flux[2], 1, 1e-6);
    }
}

TEST(LightSet, NoTexelIsFurtherFromItsLightThanTheRadius) {
    // A map with two lit texels gives one light when they share a cell; the light must be within the radius of both.
    Progress progress;
    for (int x = 0; x < 64; ++x) {
        EnvironmentMap map = one_texel_sun(256, 2 * x, 1, {1, 1, 1});
        map.pixels[256 + 2 * x + 60] = map.pixels[256 + 2 * x];
        const LightSet lights = make_light_set(map, 8, progress);
        for (const int lit : {2 * x, 2 * x + 60}) {
            const Vec3d d = direction_of(map, {lit + 0.5, 1.5});
            double nearest = 10;
            for (std::size_t i = 0; i < lights.size(); ++i)
                nearest = std::min(nearest, length(d - Vec3d{lights.x[i], lights.y[i], lights.z[i]}));
            EXPECT_LE(nearest, lights.radius);
        }
    }
}

TEST(LightSet, ItHasAboutAsManyLightsAsACubeAndNoneOfThemIsDark) {
    Progress progress;
    const LightSet lights = make_light_set(noise_map(1024, 2), 64, progress);
    // 128 bands of 256 sin(theta) cells: 128 * 256 * 2 / pi = 20,861, within the rounding of 128 bands.
    EXPECT_NEAR(double(lights.size()), 128 * 256 * 2 / std::numbers::pi, 128);
    EXPECT_EQ(make_light_set(make_map(64, [](const Vec3d&) { return Vec3d(); }), 64, progress).size(), 0u);
}

TEST(LightSet, InvalidRadianceIsAnErrorAndNotMasked) {
    Progress progress;
    for (const float bad : {-1e6f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        EnvironmentMap map = noise_map(64, 3);
        map.pixels[777].y = bad;
        EXPECT_THROW(make_light_set(map, 64, progress), Error);
    }
}

TEST(LightSet, ThreadsDoNotChangeABit) {
    const EnvironmentMap map = generate_sky(Sky::sunny, 256, 4);
    Progress progress;
    LightSet sets[3];
    const int threads[] = {1, 2, 7};
    for (int k = 0; k < 3; ++k) with_threads(threads[k], [&] { sets[k] = make_light_set(map, 64, progress); });
    for (int k = 1; k < 3; ++k) {
        EXPECT_EQ(sets[0].x, sets[k].x);
        EXPECT_EQ(sets[0].z, sets[k].z);
        EXPECT_EQ(sets[0].flux, sets[k].flux);
        EXPECT_EQ(sets[0].total, sets[k].total);
    }
}

}  // namespace
}  // namespace hairbake
