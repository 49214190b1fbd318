// Irradiance maps of environments whose maps are known in closed form.
//
// The environment itself is sampled: 512 x 256 texels with the value at their centres are a midpoint rule, wrong by
// about (pi / 256)^2 / 24 = 6e-6 per unit of second derivative of what is integrated, and light clusters of 1.4 degrees
// by (0.0245)^2 / 24 = 2.5e-5 per unit of second derivative in each of two directions. Kernels have second derivatives
// of about their exponent p and 1 for the sine, which also has a cusp on the axis that costs as much again.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/fiber/kajiya_kay.h"
#include "core/irradiance/irradiance_maps.h"
#include "tests/support/kajiya_kay.h"
#include "tests/support/make_map.h"
#include "tests/support/pixel_sum.h"

namespace hairbake {
namespace {

using std::numbers::pi;
using testing::make_map;
using testing::one_texel_sun;
using testing::sample_texels;

IrradianceMaps bake(const EnvironmentMap& map, const IrradianceSettings& settings = {}, double exponent = 64) {
    Progress progress;
    return bake_irradiance(map, settings, testing::kajiya_kay(exponent), progress);
}

// Both methods with plenty of bands for what is smooth.
std::vector<IrradianceSettings> both_methods() {
    IrradianceSettings exact, sh;
    sh.method = IrradianceMethod::sh;
    sh.sh_bands_diffuse = 9;
    sh.sh_bands_specular = 48;
    exact.specular_maps = sh.specular_maps = 9;
    return {exact, sh};
}

Vec3d direction_of_texel(int size, std::size_t i) { return sample_texels(size, 1).tangents[i]; }

void expect_everywhere(const CubeTexels& texels, int channel, double value, double tolerance) {
    for (const Vec3f& texel : texels) ASSERT_NEAR(texel[channel], value, tolerance);
}

TEST(ClosedForm, AConstantEnvironmentGivesPiSquaredForTheDiffuseMap) {
    const EnvironmentMap map = make_map(512, [](const Vec3d&) { return Vec3d{1, 0.5, 2}; });
    for (const IrradianceSettings& settings : both_methods()) {
        const IrradianceMaps maps = bake(map, settings);
        expect_everywhere(maps.diffuse, 0, pi * pi, 1e-3);
        expect_everywhere(maps.diffuse, 1, pi * pi / 2, 1e-3);
        expect_everywhere(maps.diffuse, 2, pi * pi * 2, 2e-3);
        EXPECT_NEAR(maps.diffuse_statistics.mean.x, pi * pi, 5e-4);
        EXPECT_GE(maps.diffuse_statistics.maximum.y, maps.diffuse_statistics.minimum.y);
    }
}

TEST(ClosedForm, AConstantEnvironmentGivesTheClosedFormSpecularConstants) {
    const EnvironmentMap map = make_map(512, [](const Vec3d&) { return Vec3d(1); });
    for (IrradianceSettings settings : both_methods()) {
        settings.specular_maps = 3;
        const IrradianceMaps five = bake(map, settings, 5);
        // 5 pi^2 / 8 = 6.168503 across and 2 pi / (p + 1) on the axis.
        expect_everywhere(five.specular[1], 1, 6.168503, 2e-3);
        expect_everywhere(five.specular[0], 1, 2 * pi / 6, 2e-3);
        expect_everywhere(five.specular[2], 1, 2 * pi / 6, 2e-3);
    }
}

TEST(ClosedForm, AConstantEnvironmentGivesThePublishedMapsTheirQuadratureConstants) {
    const EnvironmentMap map = make_map(512, [](const Vec3d&) { return Vec3d(1); });
    for (const IrradianceSettings& settings : both_methods()) {
        const IrradianceMaps maps = bake(map, settings);  // M = 8, p = 64
        for (int m = 0; m <= 8; ++m) {
            double constant = 0;  // midpoint rule over theta, 1e5 steps: error below 1e-7
            for (int i = 0; i < 100000; ++i) {
                const double theta = pi * (i + 0.5) / 100000;
                constant += 2 * pi * std::sin(theta) * pi / 100000 *
                            std::pow(std::max(0.0, -std::cos(theta + pi * m / 8)), 64.0);
            }
            // Relative 64 * 5e-5 = 3e-3 at a lobe's peak, but curvature integrates to nothing over a ring: what is left
            // is the noise of where cells lie. On the axis (m = 0, 8) the constant is only 2 pi / 65 = 0.097.
            expect_everywhere(maps.specular[m], 0, constant, 1e-3);
        }
    }
}

TEST(ClosedForm, ALinearGradientLeavesTheDiffuseMapAlone) {
    // sin is even in t . w, a gradient odd: its integral is zero for every t.
    const Vec3d gradient{0.3, -0.5, 0.4};
    const EnvironmentMap map = make_map(512, [&](const Vec3d& d) {
        return Vec3d{1 + dot(gradient, d), 1 - d.y, 1 + d.x};
    });
    for (const IrradianceSettings& settings : both_methods())
        for (int channel = 0; channel < 3; ++channel)
            expect_everywhere(bake(map, settings).diffuse, channel, pi * pi, 2e-3);
}

TEST(ClosedForm, ASecondBandIsDampedByMinusOneEighth) {
    // L = 1 + P_2(y): D = pi^2 (1 - P_2(t_y) / 8), because lambda_2 / lambda_0 = -1/8.
    const EnvironmentMap map = make_map(512, [](const Vec3d& d) { return Vec3d(0.5 + 1.5 * d.y * d.y); });
    for (const IrradianceSettings& settings : both_methods()) {
        const IrradianceMaps maps = bake(map, settings);
        for (std::size_t i = 0; i < maps.diffuse.size(); ++i) {
            const double y = direction_of_texel(16, i).y;
            ASSERT_NEAR(maps.diffuse[i].x, pi * pi * (1 - (1.5 * y * y - 0.5) / 8), 2e-3);
        }
    }
}

TEST(ClosedForm, ACosineLobeGivesTwoPiThirdsAlongAndEightThirdsAcross) {
    // L = max(0, d . n). Along n: 2 pi * integral of cos sin^2 = 2 pi / 3; across: 8/3.
    for (const bool along : {true, false}) {
        const IrradianceMaps probe = bake(make_map(16, [](const Vec3d&) { return Vec3d(1); }));
        const Vec3d t = direction_of_texel(16, 300);
        const Vec3d n = along ? t : normalized(cross(t, Vec3d{0.3, 0.9, -0.2}));
        const IrradianceMaps maps =
            bake(make_map(512, [&](const Vec3d& d) { return Vec3d(std::max(0.0, dot(d, n))); }));
        EXPECT_NEAR(maps.diffuse[300].x, along ? 2 * pi / 3 : 8.0 / 3, 1e-3);
        EXPECT_EQ(maps.diffuse.size(), probe.diffuse.size());
    }
}

TEST(ClosedForm, OneTexelSunsLandWhereTheyShouldInEveryConvention) {
    for (const LatLong convention : {LatLong::gltf, LatLong::filament, LatLong::openexr})
        for (const std::array<double, 3>& rotation : {std::array<double, 3>{0, 0, 0}, {90, 0, 0}, {-35, 140, 70}})
            for (const auto& [x, y] : {std::pair{128, 60}, {17, 110}, {200, 30}}) {
                const EnvironmentMap map = one_texel_sun(256, x, y, {2, 1, 0.5}, convention, rotation);
                const Vec3d sun = direction_of(map, {x + 0.5, y + 0.5});
                const IrradianceMaps maps = bake(map);  // 33 maps, p = 64
                for (const std::size_t i : {std::size_t(3), std::size_t(500), std::size_t(901), std::size_t(1400)}) {
                    const Vec3d t = direction_of_texel(16, i);
                    // E sin(angle), E lobe. Rounding of positions to 1e-7 and interpolation of the kernel: 1.2e-4.
                    EXPECT_NEAR(maps.diffuse[i].x, 2 * length(cross(t, sun)), 1e-5);
                    for (int m = 0; m <= 32; ++m) {
                        const Vec3d eye = [&] {  // any direction at theta'_m to the tangent
                            const Vec3d side = normalized(cross(t, Vec3d{0.1, 0.7, -0.6}));
                            return t * std::cos(pi * m / 32) + side * std::sin(pi * m / 32);
                        }();
                        EXPECT_NEAR(maps.specular[m][i].y, kajiya_kay_specular(t, sun, eye, 64), 2e-4);
                    }
                }
            }
}

TEST(ClosedForm, TheConventionsPutTheCentreColumnOnTheirAxes) {
    // Design: gltf +X, filament and openexr +Z; a quarter to the right +Z, +X, -X. The diffuse map of a sun is darkest
    // where the tangent points at it: the darkest texels of each map must be the four around the axis (even face size).
    const auto darkest_axis = [](const IrradianceMaps& maps) {
        std::size_t best = 0;
        for (std::size_t i = 0; i < maps.diffuse.size(); ++i)
            if (maps.diffuse[i].x < maps.diffuse[best].x) best = i;
        const Vec3d d = direction_of_texel(16, best);
        return std::abs(d.x) > 0.9 ? 'x' : std::abs(d.z) > 0.9 ? 'z' : 'y';
    };
    const auto sun_at = [](int x, LatLong c) { return one_texel_sun(256, x, 64, {1, 1, 1}, c); };
    EXPECT_EQ(darkest_axis(bake(sun_at(128, LatLong::gltf))), 'x');
    EXPECT_EQ(darkest_axis(bake(sun_at(192, LatLong::gltf))), 'z');
    EXPECT_EQ(darkest_axis(bake(sun_at(128, LatLong::filament))), 'z');
    EXPECT_EQ(darkest_axis(bake(sun_at(192, LatLong::filament))), 'x');
    EXPECT_EQ(darkest_axis(bake(sun_at(128, LatLong::openexr))), 'z');
    EXPECT_EQ(darkest_axis(bake(sun_at(192, LatLong::openexr))), 'x');
    // Signs: S_0 (eye along t) lights the tangents that point away from the sun.
    const auto brightest_x = [](const IrradianceMaps& maps) {
        std::size_t best = 0;
        for (std::size_t i = 0; i < maps.diffuse.size(); ++i)
            if (maps.specular[0][i].x > maps.specular[0][best].x) best = i;
        return direction_of_texel(16, best).x;
    };
    EXPECT_LT(brightest_x(bake(sun_at(128, LatLong::gltf))), -0.9);
    EXPECT_LT(brightest_x(bake(sun_at(192, LatLong::filament))), -0.9);
    EXPECT_GT(brightest_x(bake(sun_at(192, LatLong::openexr))), 0.9);
}

TEST(ClosedForm, ABlackEnvironmentGivesBlackMaps) {
    const EnvironmentMap map = make_map(64, [](const Vec3d&) { return Vec3d(); });
    for (const IrradianceSettings& settings : both_methods()) {
        const IrradianceMaps maps = bake(map, settings);
        expect_everywhere(maps.diffuse, 0, 0, 0);
        expect_everywhere(maps.specular[4], 2, 0, 0);
        EXPECT_EQ(maps.interpolation_bound_relative, 0);
        EXPECT_EQ(maps.predicted_error_specular, 0);
    }
}

}  // namespace
}  // namespace hairbake
