#include "core/render/light_sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/fiber/kajiya_kay.h"
#include "tests/support/kajiya_kay.h"
#include "tests/support/make_map.h"

namespace hairbake {
namespace {

using std::numbers::pi;
using testing::random_direction;

LightSet random_lights(int count) {
    Random random(9);
    LightSet lights;
    for (int i = 0; i < count; ++i) {
        const Vec3f d(random_direction(random));
        lights.x.push_back(d.x);
        lights.y.push_back(d.y);
        lights.z.push_back(d.z);
        for (int channel = 0; channel < 3; ++channel) lights.flux.push_back(float(random.next()));
        lights.flux.push_back(0);
    }
    return lights;
}

TEST(LightSum, IsTheSumOfTheExactKernelsForAnyExponentAndNumberOfLights) {
    // Directions and products in single precision: an argument of the lobe errs by some 2e-7, its p-th power by p times
    // that, of the lobe's value; sums of positive numbers keep the relative error. Numbers of lights around the block
    // of 256 show whether the padding adds nothing.
    Random random(4);
    for (const int count : {0, 1, 255, 256, 257, 3000})
        for (const double exponent : {0.0, 0.5, 1.0, 5.0, 64.0, 77.3, 4096.0}) {
            const LightSet lights = random_lights(count);
            const auto model = testing::kajiya_kay_model(exponent);
            const LightSum sum(lights, *model);
            const Vec3d t = random_direction(random), eye = random_direction(random);
            LobeSums expected{};
            for (std::size_t i = 0; i < lights.size(); ++i) {
                const Vec3d l = normalized(Vec3d(lights.x[i], lights.y[i], lights.z[i]));
                const Vec3d flux(lights.flux[4 * i], lights.flux[4 * i + 1], lights.flux[4 * i + 2]);
                expected[diffuse_lobe] += flux * kajiya_kay_diffuse(t, l);
                expected[specular_lobe] += flux * kajiya_kay_specular(t, l, eye, exponent);
            }
            const LobeSums found = sum.sum({t, eye});
            const double lobe = 1e-5 + 5e-7 * exponent;
            EXPECT_NEAR(found[diffuse_lobe].x, expected[diffuse_lobe].x, 1e-5 * expected[diffuse_lobe].x);
            EXPECT_NEAR(found[diffuse_lobe].z, expected[diffuse_lobe].z, 1e-5 * expected[diffuse_lobe].z);
            // What lies below 1e-12 of the peak is left out.
            EXPECT_NEAR(found[specular_lobe].y, expected[specular_lobe].y,
                        lobe * expected[specular_lobe].y + 1e-12 * count)
                << count << " lights, exponent " << exponent;
        }
}

TEST(LightSum, OfAWhiteSkyLightsASurfaceWithPi) {
    // Integral of the cosine over a hemisphere. Texels of 2.8 degrees: the midpoint rule errs by 1e-4 of it, and at the
    // horizon, where the cosine has a kink, by about (half a texel)^2 * circumference / 8 = 5e-4.
    const EnvironmentMap white = testing::make_map(128, [](const Vec3d&) { return Vec3d(1); });
    const auto model = testing::kajiya_kay_model(1);
    const LightSum sum(make_light_set(white, 64, Progress()), *model);
    Random random(1);
    for (int k = 0; k < 10; ++k) EXPECT_NEAR(sum.irradiance(random_direction(random)).y, pi, 6e-4 * pi);
}

}  // namespace
}  // namespace hairbake
