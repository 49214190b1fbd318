// Maps from a cube environment: against the sum over its texels, and against the same light as a lat-long map.
#include <gtest/gtest.h>

#include <cmath>

#include "core/irradiance/irradiance_maps.h"
#include "core/sample/sky_generator.h"
#include "tests/support/make_map.h"
#include "tests/support/pixel_sum.h"

namespace hairbake {
namespace {

IrradianceMaps bake(const EnvironmentMap& map, IrradianceMethod method = IrradianceMethod::exact) {
    IrradianceSettings settings;
    settings.method = method;
    settings.face_size = 8;
    settings.specular_maps = 9;
    Progress progress;
    return bake_irradiance(map, settings, {}, progress);
}

// A cube with the light of the generated sky: every texel takes the lat-long texel that its centre falls into.
EnvironmentMap sky_cube(Sky sky, int size, const std::array<double, 3>& rotation_deg = {}) {
    const EnvironmentMap map = generate_sky(sky, 512, 1);
    return testing::make_cube(
        size,
        [&](const Vec3d& d) {
            const MapPoint p = point_of(map, d);
            const int x = std::min(int(p.x), map.width - 1), y = std::min(int(p.y), map.height - 1);
            return Vec3d(map.pixels[std::size_t(y) * map.width + x]);
        },
        rotation_deg);
}

TEST(CubeEnvironment, MapsAreWithinThePromisedError) {
    // As accuracy_test.cpp has it for lat-long maps: RMS over the largest value <= 0.3 % exact, <= 1 % sh and within
    // its prediction, against the sum over every texel. 110: cells of 1 to 3 texels along an edge.
    const testing::TexelSample sample = testing::sample_texels(8, 13);
    for (const Sky sky : {Sky::sunny, Sky::studio}) {
        const EnvironmentMap map = sky_cube(sky, 110, {20, 30, 40});
        const std::vector<Vec3d> truth = testing::sum_over_pixels(map, sample.tangents, 64, 9);
        const testing::MapError exact = testing::compare(bake(map), sample.texels, truth);
        EXPECT_LE(exact.diffuse, 0.003);
        EXPECT_LE(exact.specular, 0.003);
        const IrradianceMaps sh = bake(map, IrradianceMethod::sh);
        const testing::MapError error = testing::compare(sh, sample.texels, truth);
        EXPECT_LE(error.diffuse, 0.01);
        EXPECT_LE(error.specular, 0.01);
        EXPECT_LE(error.specular, sh.predicted_error_specular);
    }
}

TEST(CubeEnvironment, ASmoothSkyGivesTheMapsOfItsLatLong) {
    // The same function on both grids: midpoint rules with errors of (texel)^2 / 24 times second derivatives of order
    // one: 1e-4 for 64 texels a face, 6e-5 for 256 columns; and the table's 2e-4.
    const auto smooth = [](const Vec3d& d) { return Vec3d{1 + d.x, 1 + d.y * d.z, 1.5 + d.y - 0.5 * d.x * d.z}; };
    const EnvironmentMap cube = testing::make_cube(64, smooth), latlong = testing::make_map(256, smooth);
    for (const IrradianceMethod method : {IrradianceMethod::exact, IrradianceMethod::sh}) {
        const IrradianceMaps a = bake(cube, method), b = bake(latlong, method);
        for (std::size_t i = 0; i < a.diffuse.size(); ++i) {
            ASSERT_LT(length(a.diffuse[i] - b.diffuse[i]), 1e-3 * length(b.diffuse[i])) << i;
            for (int m = 0; m < 9; ++m)
                ASSERT_LT(length(a.specular[m][i] - b.specular[m][i]), 1e-3 * length(b.diffuse[i])) << i << ' ' << m;
        }
        for (std::size_t i = 0; i < 9; ++i)
            EXPECT_LT(length(a.environment_sh[i] - b.environment_sh[i]), 1e-3 * length(b.environment_sh[0]));
    }
}

TEST(CubeEnvironment, ItsMeanIsExactHoweverFewTexels) {
    // The first coefficient is flux / sqrt(4 pi): with exact solid angles, 4 pi times the mean for any constant sky.
    const double pi = 3.14159265358979324;
    for (const int size : {1, 3, 64}) {
        const IrradianceMaps maps = bake(testing::make_cube(size, [](const Vec3d&) { return Vec3d{1, 2, 3}; }));
        EXPECT_LT(length(maps.environment_sh[0] - Vec3d{1, 2, 3} * std::sqrt(4 * pi)), 1e-12);
    }
}

TEST(CubeEnvironment, AQuarterTurnOfTheCubePermutesTexelsOfTheMaps) {
    // 90 degrees take texel centres to texel centres, in the environment and in the maps: only rounding differs.
    const EnvironmentMap map = sky_cube(Sky::sunny, 32);
    for (const std::array<double, 3>& angles : {std::array<double, 3>{90, 0, 0}, {0, 90, 0}, {0, 180, -90}}) {
        EnvironmentMap turned = map;
        turned.rotation = rotation_matrix(angles);
        const IrradianceMaps one = bake(map), other = bake(turned);
        const testing::TexelSample texels = testing::sample_texels(8, 1);
        const double tolerance = 1e-4 * length(Vec3d(one.diffuse_statistics.maximum));
        for (std::size_t i = 0; i < texels.texels.size(); ++i) {
            const std::size_t j = cube_texel_of(8, transform(turned.rotation, texels.tangents[i]));
            ASSERT_LT(length(Vec3d(one.diffuse[i]) - Vec3d(other.diffuse[j])), tolerance);
            for (int m = 0; m < 9; ++m)
                ASSERT_LT(length(Vec3d(one.specular[m][i]) - Vec3d(other.specular[m][j])), tolerance);
        }
    }
}

}  // namespace
}  // namespace hairbake
