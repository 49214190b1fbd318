// What must not change, or change in a known way, whatever the environment is.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/parallel.h"
#include "core/irradiance/irradiance_maps.h"
#include "core/sample/sky_generator.h"
#include "tests/support/make_map.h"
#include "tests/support/pixel_sum.h"

namespace hairbake {
namespace {

using testing::sample_texels;

IrradianceMaps bake(const EnvironmentMap& map, const IrradianceSettings& settings) {
    Progress progress;
    return bake_irradiance(map, settings, {}, progress);
}

IrradianceSettings small(IrradianceMethod method) {
    IrradianceSettings settings;
    settings.method = method;
    settings.face_size = 8;
    settings.specular_maps = 9;
    return settings;
}

constexpr IrradianceMethod methods[] = {IrradianceMethod::exact, IrradianceMethod::sh};

double largest(const CubeTexels& texels) {
    float value = 0;
    for (const Vec3f& t : texels) value = std::max({value, t.x, t.y, t.z});
    return value;
}

void expect_close(const CubeTexels& a, const CubeTexels& b, double tolerance) {
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_LT(length(a[i] - b[i]), tolerance) << i;
}

TEST(Invariance, ReversingTheTangentReversesTheViewAngle) {
    // D(-t) = D(t), S_m(-t) = S_M-m(t). `exact` uses this (so it is exact there), `sh` does not: rounding of floats.
    const EnvironmentMap map = generate_sky(Sky::sunny, 256, 1);
    for (const IrradianceMethod method : methods) {
        const IrradianceMaps maps = bake(map, small(method));
        const double tolerance = method == IrradianceMethod::exact ? 1e-30 : 1e-5 * largest(maps.diffuse);
        for (std::size_t i = 0; i < maps.diffuse.size(); ++i) {
            const std::size_t j = cube_antipode(8, i);
            ASSERT_LT(length(maps.diffuse[i] - maps.diffuse[j]), tolerance);
            for (int m = 0; m <= 8; ++m) ASSERT_LT(length(maps.specular[m][i] - maps.specular[8 - m][j]), tolerance);
        }
    }
}

TEST(Invariance, MapsAreLinearInTheEnvironment) {
    // a + 3 b in pixels gives A + 3 B in maps. Exactly so when every texel keeps its own light (32 x 16); a sum of
    // lights' clusters would move centroids. sh with fixed bands. Tolerance: single precision.
    EnvironmentMap a = testing::noise_map(32, 1), b = testing::noise_map(32, 2), sum = a;
    for (std::size_t i = 0; i < sum.pixels.size(); ++i) sum.pixels[i] = a.pixels[i] + b.pixels[i] * 3.0f;
    for (const IrradianceMethod method : methods) {
        IrradianceSettings settings = small(method);
        settings.sh_bands_diffuse = settings.sh_bands_specular = 10;
        settings.clamp_negative = false;
        const IrradianceMaps ma = bake(a, settings), mb = bake(b, settings), ms = bake(sum, settings);
        for (std::size_t i = 0; i < ms.diffuse.size(); ++i) {
            ASSERT_LT(length(ma.diffuse[i] + mb.diffuse[i] * 3.0f - ms.diffuse[i]), 1e-4 * largest(ms.diffuse));
            // The texels of the rows at the poles share lights: their centroids move by half a texel (0.1 rad) of 1 %
            // of the flux, the lobe's slope is 5.
            for (int m = 0; m <= 8; ++m)
                ASSERT_LT(length(ma.specular[m][i] + mb.specular[m][i] * 3.0f - ms.specular[m][i]),
                          (method == IrradianceMethod::exact ? 5e-3 : 1e-5) * largest(ms.diffuse));
        }
    }
}

TEST(Invariance, RotatingTheMapAndTheTangentsTogetherChangesNothing) {
    // A quarter turn about each axis takes texel centres of the cube to texel centres: no look-up error enters.
    const EnvironmentMap map = generate_sky(Sky::sunny, 256, 3);
    const testing::TexelSample texels = sample_texels(8, 1);
    for (const IrradianceMethod method : methods)
        for (const std::array<double, 3>& angles :
             {std::array<double, 3>{90, 0, 0}, {0, 90, 0}, {0, 0, 90}, {90, 180, -90}}) {
            EnvironmentMap turned = map;
            turned.rotation = rotation_matrix(angles);
            const IrradianceMaps one = bake(map, small(method)), other = bake(turned, small(method));
            const double tolerance =
                1e-4 * largest(one.diffuse);  // positions in single precision times the lobe's slope
            for (std::size_t i = 0; i < texels.texels.size(); ++i) {
                const std::size_t j = cube_texel_of(8, transform(turned.rotation, texels.tangents[i]));
                ASSERT_LT(length(one.diffuse[i] - other.diffuse[j]), tolerance);
                for (int m = 0; m <= 8; ++m) ASSERT_LT(length(one.specular[m][i] - other.specular[m][j]), tolerance);
            }
        }
}

TEST(Invariance, ShiftingColumnsIsTurningAboutTheVerticalAxis) {
    // gltf: a direction at azimuth phi is (cos phi, sin phi) in (x, z); moving pixels right by width/8 adds 45 degrees
    // to phi, which is -45 degrees about Y right-handed (Z goes to X).
    const EnvironmentMap map = generate_sky(Sky::sunny, 256, 4);
    EnvironmentMap shifted = map, turned = map;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x)
            shifted.pixels[std::size_t(y) * 256 + (x + 32) % 256] = map.pixels[std::size_t(y) * 256 + x];
    turned.rotation = rotation_matrix({0, -45, 0});
    for (const IrradianceMethod method : methods) {
        const IrradianceMaps a = bake(shifted, small(method)), b = bake(turned, small(method));
        // sh: rounding. exact: cells of some bands are cut differently, which moves their centroids (errors of 1e-4,
        // see accuracy).
        const double tolerance = (method == IrradianceMethod::exact ? 1e-3 : 1e-5) * largest(a.diffuse);
        expect_close(a.diffuse, b.diffuse, tolerance);
        for (int m = 0; m <= 8; ++m) expect_close(a.specular[m], b.specular[m], tolerance);
    }
}

TEST(Invariance, ThreadsDoNotChangeABit) {
    const EnvironmentMap map = generate_sky(Sky::studio, 256, 5);
    for (const IrradianceMethod method : methods) {
        IrradianceMaps maps[3];
        const int threads[] = {1, 2, 7};
        for (int k = 0; k < 3; ++k) with_threads(threads[k], [&] { maps[k] = bake(map, small(method)); });
        for (int k = 1; k < 3; ++k) {
            EXPECT_EQ(maps[0].diffuse, maps[k].diffuse);
            EXPECT_EQ(maps[0].specular, maps[k].specular);
            EXPECT_EQ(maps[0].environment_sh, maps[k].environment_sh);
            EXPECT_EQ(maps[0].interpolation_bound, maps[k].interpolation_bound);
            EXPECT_EQ(maps[0].predicted_error_specular, maps[k].predicted_error_specular);
            EXPECT_EQ(maps[0].diffuse_statistics.mean, maps[k].diffuse_statistics.mean);
        }
    }
}

TEST(Invariance, TheReportedHarmonicsAreThoseOfTheWorld) {
    // The first four coefficients of a sun: flux * (1, sqrt 3 y, sqrt 3 z, sqrt 3 x) / sqrt(4 pi).
    const EnvironmentMap map = testing::one_texel_sun(128, 90, 20, {1, 2, 3}, LatLong::filament, {0, 30, 60});
    const Vec3d d = direction_of(map, {90.5, 20.5});
    for (const IrradianceMethod method : methods) {
        const IrradianceMaps maps = bake(map, small(method));
        EXPECT_GE(maps.environment_sh_bands, 8);
        ASSERT_EQ(maps.environment_sh.size(), std::size_t(maps.environment_sh_bands * maps.environment_sh_bands));
        const double c = 1 / std::sqrt(4 * 3.14159265358979324), root3 = std::sqrt(3.0);
        const double expected[] = {c, c * root3 * d.y, c * root3 * d.z, c * root3 * d.x};
        for (int i = 0; i < 4; ++i)  // texel radiance in single precision
            EXPECT_LT(length(maps.environment_sh[i] - Vec3d{1, 2, 3} * expected[i]), 1e-6);
    }
}

}  // namespace
}  // namespace hairbake
