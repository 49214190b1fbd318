#include "core/irradiance/effective_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/environment/cube_map.h"
#include "core/fiber/kajiya_kay.h"
#include "tests/support/make_map.h"

namespace hairbake {
namespace {

std::unique_ptr<const FiberModel> model_of(double exponent) {
    FiberSettings settings;
    settings.kajiya_kay.exponent = exponent;
    return make_fiber_model(settings);
}

std::vector<ClusteredLight> random_lights(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<ClusteredLight> lights;
    for (std::size_t k = 0; k < count; ++k) {
        const Vec3d direction = testing::random_direction(random);
        lights.push_back({direction, {random.next(), random.next(), 10 * std::pow(random.next(), 8)}});
    }
    return lights;
}

EffectiveTable table_of(std::span<const ClusteredLight> lights, double exponent = 64,
                        const EffectiveSettings& settings = {}) {
    Progress progress;
    return make_effective_table(lights, *model_of(exponent), settings, progress);
}

/// Sums of a cell's weights times `transmittance` of each light.
std::vector<double> sums(const EffectiveTable& table, std::size_t cell, const std::vector<double>& transmittance) {
    std::vector<double> sums(table.components);
    for (std::size_t k = 0; k < table.lights; ++k)
        for (std::size_t c = 0; c < table.components; ++c)
            sums[c] += transmittance[k] * double(table.values[(cell * table.lights + k) * table.components + c]);
    return sums;
}

TEST(EffectiveTable, WithoutHairInTheWayGivesOneAndNoCosines) {
    // Weights are rounded to single precision: 2^-24 of each, and the sum of their magnitudes is below 10 here.
    for (const double exponent : {0.0, 16.0, 64.0, 512.0})
        for (const int cosines : {1, 3, 5}) {
            EffectiveSettings settings;
            settings.cosines = cosines;
            const EffectiveTable table = table_of(random_lights(48, 7), exponent, settings);
            const std::vector<double> open(table.lights, 1.0);
            for (std::size_t cell = 0; cell<table.cells(); cell += exponent> 64 ? 97 : 1) {
                const auto sum = sums(table, cell, open);
                for (std::size_t c = 0; c < sum.size(); ++c)
                    ASSERT_NEAR(sum[c], c <= 3 ? 1 : 0, 1e-6) << exponent << " " << cosines << " " << cell << " " << c;
            }
        }
}

TEST(EffectiveTable, SizesFollowTheSharpness) {
    EXPECT_EQ(effective_refinement(0), 1);
    EXPECT_EQ(effective_refinement(64), 1);
    EXPECT_NEAR(effective_refinement(512), std::sqrt(8.0), 1e-12);
    EXPECT_EQ(effective_refinement(1e6), 4);
    EXPECT_EQ(table_of(random_lights(3, 1), 64).face_size, 16);
    EXPECT_EQ(table_of(random_lights(3, 1), 512).face_size, 45);  // 16 sqrt(8)
}

TEST(EffectiveTable, ExposureChangesNothing) {
    const std::vector<ClusteredLight> lights = random_lights(64, 9);
    const EffectiveTable table = table_of(lights);
    for (const double stops : {-20.0, 20.0}) {  // powers of two: exact in every product and quotient
        std::vector<ClusteredLight> exposed = lights;
        for (ClusteredLight& light : exposed) light.flux = light.flux * std::exp2(stops);
        EXPECT_EQ(table_of(exposed).values, table.values) << stops;
    }
}

TEST(EffectiveTable, AWhiteSkyWeighsBySine) {
    std::vector<ClusteredLight> lights = random_lights(64, 11);
    for (ClusteredLight& light : lights) light.flux = Vec3d(1);
    const EffectiveTable table = table_of(lights);
    for (std::size_t cell = 0; cell < table.cells() - 1; cell += 31) {
        const Vec3d t = cube_texel_direction(16, int(cell / 256), int(cell / 16 % 16), int(cell % 16));
        double all = 0;
        for (const ClusteredLight& light : lights) all += kajiya_kay_diffuse(t, light.direction);
        for (std::size_t k = 0; k < lights.size(); ++k)
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(table.values[(cell * 64 + k) * 6 + c], kajiya_kay_diffuse(t, lights[k].direction) / all,
                            1e-7);
    }
}

TEST(EffectiveTable, OneLampIsItsOwnTransmittance) {
    const std::vector<ClusteredLight> lamp{{normalized(Vec3d{1, 2, -2}), {3, 2, 1}}};
    const EffectiveTable table = table_of(lamp);
    for (std::size_t cell = 0; cell < table.cells(); ++cell)
        for (const double t : {0.0, 0.3, 1.0}) {
            const auto sum = sums(table, cell, {t});
            for (std::size_t c = 0; c < 6; ++c) ASSERT_NEAR(sum[c], c <= 3 ? t : 0, 1e-6) << cell << " " << c;
        }
}

TEST(EffectiveTable, AChannelWithoutLightHasTheWeightsOfLuminance) {
    std::vector<ClusteredLight> lights = random_lights(32, 13);
    for (ClusteredLight& light : lights) light.flux.z = 0;
    const EffectiveTable rgb = table_of(lights);
    EffectiveSettings settings;
    settings.diffuse = EffectiveDiffuse::luminance;
    const EffectiveTable grey = table_of(lights, 64, settings);
    ASSERT_EQ(grey.components, 4u);
    for (std::size_t i = 0; i < rgb.cells() * rgb.lights; ++i) {
        EXPECT_EQ(rgb.values[i * 6 + 2], grey.values[i * 4]);
        for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(rgb.values[i * 6 + 3 + j], grey.values[i * 4 + 1 + j]);
    }
}

TEST(EffectiveTable, WithoutLightItIsTheMean) {
    std::vector<ClusteredLight> lights = random_lights(4, 15);
    for (ClusteredLight& light : lights) light.flux = Vec3d();
    const EffectiveTable table = table_of(lights);
    for (std::size_t cell = 0; cell < table.cells(); ++cell) {
        const auto sum = sums(table, cell, {1, 0, 0.5, 0.5});
        for (std::size_t c = 0; c < 6; ++c) ASSERT_NEAR(sum[c], c <= 3 ? 0.5 : 0, 1e-6);
    }
}

TEST(EffectiveTable, ATurnedTangentChangesTheSignOfTheOddCosinesOnly) {
    // K(-t, l, theta') = K(t, l, pi - theta'), and cos(j (pi - theta')) = (-1)^j cos(j theta').
    EffectiveSettings settings;
    settings.cosines = 5;
    const EffectiveTable table = table_of(random_lights(48, 17), 64, settings);
    for (std::size_t cell = 0; cell < table.cells() - 1; ++cell) {
        const std::size_t opposite = cube_antipode(16, cell);
        for (std::size_t k = 0; k < table.lights; ++k)
            for (std::size_t c = 0; c < 8; ++c) {
                const float here = table.values[(cell * table.lights + k) * 8 + c];
                const float there = table.values[(opposite * table.lights + k) * 8 + c];
                ASSERT_NEAR(here, c == 4 || c == 6 ? -there : there, 1e-6 * (1 + std::abs(here))) << cell << " " << c;
            }
    }
}

TEST(EffectiveTable, TheSpecularSeriesIsTheLeastSquaresFit) {
    // Any other series has a larger sum over theta' of sin theta' S^2 (As - true)^2, up to the ridge of a thousandth.
    const std::vector<ClusteredLight> lights = random_lights(24, 19);
    const EffectiveTable table = table_of(lights);
    Random random(3);
    std::vector<double> transmittance;
    for (std::size_t k = 0; k < lights.size(); ++k) transmittance.push_back(random.next() < 0.5 ? 0 : 1);
    const std::size_t cell = 300;
    const Vec3d t = cube_texel_direction(16, int(cell / 256), int(cell / 16 % 16), int(cell % 16));
    const auto fitted = sums(table, cell, transmittance);
    const auto loss = [&](double c0, double c1, double c2) {
        double sum = 0;
        for (int i = 0; i <= 900; ++i) {
            const double theta = 3.14159265358979 * i / 900;
            for (int c = 0; c < 3; ++c) {
                double open = 0, seen = 0;
                for (std::size_t k = 0; k < lights.size(); ++k) {
                    const double theta_k = std::acos(dot(t, lights[k].direction));
                    const double light = lights[k].flux[c] * kajiya_kay_specular(theta_k, theta, 64);
                    open += light;
                    seen += light * transmittance[k];
                }
                const double series = c0 + c1 * std::cos(theta) + c2 * std::cos(2 * theta);
                sum += std::sin(theta) * (open * series - seen) * (open * series - seen);
            }
        }
        return sum;
    };
    const double best = loss(fitted[3], fitted[4], fitted[5]);
    for (const double step : {0.05, -0.05}) {
        EXPECT_LT(best, loss(fitted[3] + step, fitted[4], fitted[5]));
        EXPECT_LT(best, loss(fitted[3], fitted[4] + step, fitted[5]));
        EXPECT_LT(best, loss(fitted[3], fitted[4], fitted[5] + step));
    }
}

TEST(EffectiveTable, IsTheSameForAnyThreadCount) {
    const std::vector<ClusteredLight> lights = random_lights(64, 21);
    std::vector<std::vector<float>> results;
    for (const int threads : {1, 2, 7}) with_threads(threads, [&] { results.push_back(table_of(lights).values); });
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace hairbake
