// Directional lights against the kernel itself, against a sun in the environment, and what they must not touch.
#include "core/irradiance/added_lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/fiber/kajiya_kay.h"
#include "core/sample/sky_generator.h"
#include "tests/support/kajiya_kay.h"
#include "tests/support/make_map.h"

namespace hairbake {
namespace {

using std::numbers::pi;

constexpr IrradianceMethod methods[] = {IrradianceMethod::exact, IrradianceMethod::sh};
constexpr int size = 8, maps = 9;

const EnvironmentMap& black() {
    static const EnvironmentMap map = testing::make_map(32, [](const Vec3d&) { return Vec3d(); });
    return map;
}

const EnvironmentMap& sky() {
    static const EnvironmentMap map = generate_sky(Sky::studio, 128, 2);
    return map;
}

IrradianceMaps bake(const EnvironmentMap& map, std::vector<DirectionalLight> lights,
                    IrradianceMethod method = IrradianceMethod::exact, double exponent = 64) {
    IrradianceSettings settings;
    settings.method = method;
    settings.face_size = size;
    settings.specular_maps = maps;
    settings.lights = std::move(lights);
    Progress progress;
    return bake_irradiance(map, settings, testing::kajiya_kay(exponent), progress);
}

const CubeTexels& map_of(const IrradianceMaps& m, int k) { return k == 0 ? m.diffuse : m.specular[k - 1]; }

double largest(const IrradianceMaps& m) {
    float value = 0;
    for (int k = 0; k <= maps; ++k)
        for (const Vec3f& t : map_of(m, k)) value = std::max({value, t.x, t.y, t.z});
    return value;
}

double worst_difference(const IrradianceMaps& a, const IrradianceMaps& b) {
    double worst = 0;
    for (int k = 0; k <= maps; ++k)
        for (std::size_t i = 0; i < map_of(a, k).size(); ++i)
            worst = std::max(worst, length(Vec3d(map_of(a, k)[i]) - Vec3d(map_of(b, k)[i])));
    return worst;
}

std::vector<DirectionalLight> some_lights(int count) {
    Random random(7);
    std::vector<DirectionalLight> lights;
    for (int i = 0; i < count; ++i) {
        const Vec3d direction = testing::random_direction(random) * 3.0;  // any length
        const double red = random.next(), green = random.next(), blue = random.next();
        lights.push_back({direction, {red, green, blue}});
    }
    return lights;
}

TEST(AddedLights, OneLightIsTheKernelTexelByTexel) {
    // Angles by acos, kernels by the two-angle form: another way than the sines and cosines that the maps use. Single
    // precision is 6e-8; the angle by acos loses 1e-8 near the poles of t, times the lobe's slope sqrt(p/e) < 20.
    const DirectionalLight light{{0.3, -2, 1}, {3, 0.5, 20}};
    const Vec3d d = normalized(light.direction);
    for (const double exponent : {0.0, 1.0, 64.0, 500.5}) {
        const IrradianceMaps m = bake(black(), {light}, IrradianceMethod::exact, exponent);
        for (int face = 0; face < cube_faces; ++face)
            for (int i = 0; i < size * size; ++i) {
                const std::size_t texel = std::size_t(face) * size * size + i;
                const double theta = std::acos(dot(cube_texel_direction(size, face, i / size, i % size), d));
                ASSERT_LT(length(Vec3d(m.diffuse[texel]) - light.irradiance * std::sin(theta)), 20 * 2e-7);
                for (int k = 0; k < maps; ++k)
                    ASSERT_LT(length(Vec3d(m.specular[k][texel]) -
                                     light.irradiance * kajiya_kay_specular(theta, pi * k / (maps - 1), exponent)),
                              20 * 5e-7)
                        << exponent << ' ' << texel << ' ' << k;
            }
    }
}

TEST(AddedLights, BothMethodsAddTheSame) {
    // What a light adds to the sky's maps is what it adds to black: rounding of floats at the sky's largest value.
    const std::vector<DirectionalLight> lights = some_lights(3);
    const IrradianceMaps alone = bake(black(), lights);
    for (const IrradianceMethod method : methods) {
        const IrradianceMaps with = bake(sky(), lights, method);
        IrradianceMaps sum = bake(sky(), {}, method);
        for (std::size_t i = 0; i < sum.diffuse.size(); ++i) {
            sum.diffuse[i] += alone.diffuse[i];
            for (int k = 0; k < maps; ++k) sum.specular[k][i] += alone.specular[k][i];
        }
        EXPECT_LT(worst_difference(with, sum), 1e-6 * largest(with));
    }
}

TEST(AddedLights, AOneTexelSunInTheEnvironmentIsTheSameLight) {
    // The sun's light stands at the texel's centre with the texel's flux (light_set.h): the limit of a small sun. The
    // exact method tabulates kernels: 2e-4 of the peak (kernel_sum.h). sh is not compared: it cannot hold a sun.
    const Vec3d flux{2, 3, 5};
    for (const LatLong convention : {LatLong::gltf, LatLong::filament, LatLong::openexr}) {
        const EnvironmentMap sun = testing::one_texel_sun(512, 301, 77, flux, convention, {10, 20, 30});
        const IrradianceMaps quadrature = bake(sun, {});
        const IrradianceMaps added = bake(black(), {{direction_of(sun, {301.5, 77.5}), flux}});
        EXPECT_LT(worst_difference(quadrature, added), 4e-4 * length(flux));
    }
}

TEST(AddedLights, ALightIsLinearInItsIrradianceAndSplitsInTwo) {
    const std::vector<DirectionalLight> lights = some_lights(1);
    const DirectionalLight half{lights[0].direction, lights[0].irradiance * 0.5};
    EXPECT_EQ(worst_difference(bake(black(), lights), bake(black(), {half, half})), 0) << "halves are exact";
    const DirectionalLight eight{lights[0].direction * 100.0, lights[0].irradiance * 8.0};
    const IrradianceMaps one = bake(black(), lights), more = bake(black(), {eight});
    for (std::size_t i = 0; i < one.diffuse.size(); ++i)  // the direction's length only rounds
        ASSERT_LT(length(one.diffuse[i] * 8.0f - more.diffuse[i]), 1e-5);
}

TEST(AddedLights, TheirOrderDoesNotMatter) {
    // Sums in double, stored as floats: one rounding of the largest value.
    std::vector<DirectionalLight> lights = some_lights(64);
    const IrradianceMaps one = bake(black(), lights);
    std::reverse(lights.begin(), lights.end());
    EXPECT_LT(worst_difference(one, bake(black(), lights)), 2e-7 * largest(one));
}

TEST(AddedLights, ReversingTheTangentReversesTheViewAngle) {
    // D(-t) = D(t), S_m(-t) = S_M-m(t), bit for bit where the environment's maps have it (exact).
    const IrradianceMaps m = bake(sky(), some_lights(5));
    for (std::size_t i = 0; i < m.diffuse.size(); ++i) {
        const std::size_t opposite = cube_antipode(size, i);
        ASSERT_EQ(m.diffuse[i], m.diffuse[opposite]);
        for (int k = 0; k < maps; ++k) ASSERT_EQ(m.specular[k][i], m.specular[maps - 1 - k][opposite]);
    }
}

TEST(AddedLights, RotationAndExposureOfTheEnvironmentDoNotActOnThem) {
    EnvironmentMap turned = black();
    turned.rotation = rotation_matrix({30, 40, 50});
    EXPECT_EQ(worst_difference(bake(black(), some_lights(2)), bake(turned, some_lights(2))), 0);
}

TEST(AddedLights, StatisticsHoldThemButHarmonicsAndPredictedErrorDoNot) {
    const std::vector<DirectionalLight> lights{{{0, 1, 0}, {40, 40, 40}}};
    for (const IrradianceMethod method : methods) {
        const IrradianceMaps without = bake(sky(), {}, method), with = bake(sky(), lights, method);
        EXPECT_EQ(with.environment_sh, without.environment_sh);
        EXPECT_EQ(with.predicted_error_diffuse, without.predicted_error_diffuse);
        EXPECT_EQ(with.predicted_error_specular, without.predicted_error_specular);
        EXPECT_EQ(with.sh_bands_specular, without.sh_bands_specular);
        EXPECT_EQ(with.diffuse_statistics.clamped_negative_mass, without.diffuse_statistics.clamped_negative_mass);
        // The mean of sin over the sphere is pi/4; a cube of 8 samples it to 1 %.
        const Vec3d added = with.diffuse_statistics.mean - without.diffuse_statistics.mean;
        EXPECT_LT(length(added - Vec3d(40 * pi / 4)), 0.01 * 40 * pi / 4);
        EXPECT_GT(with.diffuse_statistics.maximum.x, without.diffuse_statistics.maximum.x);
    }
}

TEST(AddedLights, TheInterpolationBoundHoldsWithThem) {
    // |(1 - f) S_m + f S_m+1 - S| at texels of one light: known in closed form, and nowhere above the bound. It is also
    // of the right size: at least half of the bound is reached by a single light.
    const DirectionalLight light{{0.3, 0.5, -1}, {1, 1, 1}};
    const Vec3d d = normalized(light.direction);
    for (const IrradianceMethod method : methods)
        for (const int n : {8, 16}) {
            IrradianceSettings settings;
            settings.method = method;
            settings.face_size = n;
            settings.specular_maps = maps;
            settings.lights = {light};
            Progress progress;
            const IrradianceMaps m = bake_irradiance(black(), settings, {}, progress);
            double worst = 0;
            for (std::size_t texel = 0; texel < m.diffuse.size(); ++texel) {
                const int i = int(texel) % (n * n);
                const double theta = std::acos(dot(cube_texel_direction(n, int(texel) / n / n, i / n, i % n), d));
                for (int k = 0; k + 1 < maps; ++k)
                    for (const double f : {0.1, 0.3, 0.5, 0.7, 0.9}) {
                        const double truth = kajiya_kay_specular(theta, pi * (k + f) / (maps - 1), 64);
                        const double between = (1 - f) * m.specular[k][texel].x + f * m.specular[k + 1][texel].x;
                        worst = std::max(worst, std::abs(between - truth));
                    }
            }
            EXPECT_LE(worst, m.interpolation_bound.x);
            EXPECT_GT(worst, 0.5 * m.interpolation_bound.x);
            EXPECT_GT(m.interpolation_bound_relative, 0.3) << "nine maps are few at p = 64";
        }
}

TEST(AddedLights, WithoutLightsTheBoundIsTheEnvironments) {
    const LightSet lights = make_light_set(sky(), 32, Progress());
    const LightSet same = with_directional_lights(lights, {});
    EXPECT_EQ(same.flux, lights.flux);
    EXPECT_EQ(same.x, lights.x);
}

TEST(AddedLights, ThreadsDoNotChangeABit) {
    IrradianceMaps m[2];
    for (int k = 0; k < 2; ++k) with_threads(1 + 4 * k, [&] { m[k] = bake(sky(), some_lights(9)); });
    EXPECT_EQ(worst_difference(m[0], m[1]), 0);
    EXPECT_EQ(m[0].interpolation_bound, m[1].interpolation_bound);
}

TEST(AddedLights, LightsThatCannotBeAreRefused) {
    const double inf = std::numeric_limits<double>::infinity();
    for (const DirectionalLight& light :
         {DirectionalLight{{0, 0, 0}, {1, 1, 1}}, DirectionalLight{{inf, 0, 0}, {}},
          DirectionalLight{{1, 0, 0}, {-1, 0, 0}}, DirectionalLight{{1, 0, 0}, {std::nan(""), 0, 0}}}) {
        try {
            bake(black(), {light});
            FAIL() << "taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_EQ(error.field(), "irradiance.lights");
        }
    }
    EXPECT_THROW(bake(black(), std::vector<DirectionalLight>(65, {{1, 0, 0}, {}})), Error);
}

}  // namespace
}  // namespace hairbake
