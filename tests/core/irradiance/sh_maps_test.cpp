#include "core/irradiance/sh_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/fiber/kajiya_kay.h"
#include "core/sample/sky_generator.h"
#include "tests/support/kajiya_kay.h"
#include "tests/support/make_map.h"
#include "tests/support/pixel_sum.h"
#include "tests/support/transfer_matrix.h"

namespace hairbake {
namespace {

using std::numbers::pi;

IrradianceSettings published() {
    IrradianceSettings settings;
    settings.method = IrradianceMethod::sh;
    settings.sh_bands_diffuse = 3;
    settings.sh_bands_specular = 8;
    settings.specular_maps = 9;
    return settings;
}

TEST(ShMaps, TheyEqualThePublishedTransferMatrix) {
    // Equation 11's brute-force table against lambda_l. The table integrates the kernel over the map's own texels (192
    // x 96: a midpoint rule, (pi / 96)^2 / 24 * 64 = 3e-3 of the kernel at p = 64, 5e-5 for the sine), lambda does so
    // exactly.
    Progress progress;
    const EnvironmentMap map = testing::noise_map(192, 1, LatLong::openexr, {20, 30, 40});
    IrradianceSettings settings = published();
    settings.clamp_negative = false;
    settings.face_size = 4;
    const IrradianceMaps maps = bake_irradiance(map, settings, {}, progress);
    const testing::TexelSample sample = testing::sample_texels(4, 7);
    const std::vector<Vec3d> diffuse = testing::transfer_matrix_map(
        map, sample.tangents, 3, [](double c) { return std::sqrt(std::max(0.0, 1 - c * c)); });
    for (std::size_t k = 0; k < sample.texels.size(); ++k)
        EXPECT_LT(length(Vec3d(maps.diffuse[sample.texels[k]]) - diffuse[k]), 2e-4 * length(diffuse[k]));
    for (const int m : {0, 3, 8}) {
        const std::vector<Vec3d> specular = testing::transfer_matrix_map(map, sample.tangents, 8, [&](double c) {
            return kajiya_kay_specular(std::acos(std::clamp(c, -1.0, 1.0)), pi * m / 8, 64);
        });
        for (std::size_t k = 0; k < sample.texels.size(); ++k)
            EXPECT_LT(length(Vec3d(maps.specular[m][sample.texels[k]]) - specular[k]), 3e-3 * length(specular[k])) << m;
    }
}

TEST(ShMaps, ManyBandsAgreeWithTheSumOverPixels) {
    Progress progress;
    IrradianceSettings settings = published();
    settings.sh_bands_diffuse = settings.sh_bands_specular = 64;
    settings.face_size = 8;
    const EnvironmentMap map = generate_sky(Sky::sunny, 256, 2);
    const IrradianceMaps maps = bake_irradiance(map, settings, {}, progress);
    const testing::TexelSample sample = testing::sample_texels(8, 5);
    const testing::MapError error =
        testing::compare(maps, sample.texels, testing::sum_over_pixels(map, sample.tangents, 64, 9));
    // Specular: nothing is left of cos^64 in 64 bands. Diffuse: the sine's tail for a sun, square root of the sum over
    // even l >= 64 of lambda_l^2 (2l + 1) / (4 pi)^2 with lambda_l = 4 / l^3 for large l: about sqrt(4 / (4 pi)^2 /
    // 64^4) = 4e-5; it gathers at the pole of the sine, which few texels meet.
    EXPECT_LT(error.specular, 1e-5);
    EXPECT_LT(error.diffuse, 1e-4);
    EXPECT_EQ(maps.environment_sh_bands, 32);
}

TEST(ShMaps, NegativeValuesAreClampedAndTheirMassReported) {
    Progress progress;
    const EnvironmentMap map = testing::one_texel_sun(128, 40, 30, {1, 1, 1});
    IrradianceSettings settings = published();
    const IrradianceMaps clamped = bake_irradiance(map, settings, {}, progress);
    settings.clamp_negative = false;
    const IrradianceMaps raw = bake_irradiance(map, settings, {}, progress);
    const std::vector<double> solid_angles = cube_texel_solid_angles(16);
    for (int m = 0; m <= 8; ++m) {
        double mass = 0;
        for (std::size_t i = 0; i < raw.diffuse.size(); ++i) {
            for (int c = 0; c < 3; ++c) {
                const float value = raw.specular[m][i][c];
                mass += std::max(0.0, -double(value)) * solid_angles[i % 256];
                ASSERT_EQ(clamped.specular[m][i][c], std::max(0.0f, value));
            }
        }
        EXPECT_GT(mass, 0.01);  // eight bands of cos^64 ring (docs/math.md, "Spherical harmonics": down to -0.35)
        EXPECT_NEAR(clamped.specular_statistics[m].clamped_negative_mass, mass, 1e-6 * mass);
        EXPECT_NEAR(raw.specular_statistics[m].clamped_negative_mass, mass, 1e-6 * mass);
        EXPECT_GE(clamped.specular_statistics[m].minimum.x, 0);
    }
}

TEST(ShMaps, AutoNeedsMoreBandsForASmallerErrorAndASharperLobe) {
    Progress progress;
    const EnvironmentMap map = generate_sky(Sky::sunny, 256, 1);
    IrradianceSettings settings;
    settings.method = IrradianceMethod::sh;
    settings.specular_maps = 5;
    int before = 0;
    for (const double target : {0.05, 0.01, 0.002}) {
        settings.sh_error = target;
        const IrradianceMaps maps = bake_irradiance(map, settings, {}, progress);
        EXPECT_GT(maps.sh_bands_specular, before);
        EXPECT_LE(maps.predicted_error_specular, target);
        EXPECT_LE(maps.predicted_error_diffuse, target);
        before = maps.sh_bands_specular;
    }
    settings.sh_error = 0.01;
    const int at64 = bake_irradiance(map, settings, {}, progress).sh_bands_specular;
    EXPECT_GT(bake_irradiance(map, settings, testing::kajiya_kay(256), progress).sh_bands_specular, at64);
    settings.sh_error = 1e-4;
    const IrradianceMaps most = bake_irradiance(map, settings, testing::kajiya_kay(4096), progress);
    EXPECT_EQ(most.sh_bands_specular, 128);
    EXPECT_GT(most.predicted_error_specular, 1e-4);
    bool warned = false;
    for (const std::string& warning : most.warnings) warned |= warning.find("128 bands") != std::string::npos;
    EXPECT_TRUE(warned);
}

}  // namespace
}  // namespace hairbake
