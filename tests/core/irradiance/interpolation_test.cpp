#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/fiber/kajiya_kay.h"
#include "core/irradiance/irradiance_maps.h"
#include "core/irradiance/lookup.h"
#include "core/sample/sky_generator.h"
#include "tests/support/make_map.h"

namespace hairbake {
namespace {

using std::numbers::pi;
using testing::random_direction;

IrradianceMaps bake(const EnvironmentMap& map, const IrradianceSettings& settings) {
    Progress progress;
    return bake_irradiance(map, settings, {}, progress);
}

Vec3d eye_at(const Vec3d& t, double theta) {
    const Vec3d side = normalized(cross(t, std::abs(t.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}));
    return t * std::cos(theta) + side * std::sin(theta);
}

TEST(LookUp, AtTexelsAndMapAnglesItGivesTheTexels) {
    const IrradianceMaps maps = bake(generate_sky(Sky::studio, 128, 1), {});
    for (const std::size_t i : {std::size_t(0), std::size_t(333), std::size_t(1200)}) {
        const Vec3d t = cube_texel_direction(16, int(i / 256), int(i / 16 % 16), int(i % 16));
        EXPECT_LT(length(look_up_diffuse(maps, t) - Vec3d(maps.diffuse[i])), 1e-6);
        for (const int m : {0, 7, 31, 32}) {
            // acos near the axis loses half the digits: 1e-8 rad times the largest slope between maps (values up to 2,
            // 10 a rad).
            EXPECT_LT(length(look_up_specular(maps, t, eye_at(t, pi * m / 32)) - Vec3d(maps.specular[m][i])), 1e-5);
        }
        const Vec3d half = look_up_specular(maps, t, eye_at(t, pi * 7.5 / 32));
        EXPECT_LT(length(half - (Vec3d(maps.specular[7][i]) + Vec3d(maps.specular[8][i])) / 2.0), 1e-5);
    }
}

TEST(InterpolationBound, ItHoldsForASunAndIsNotMuchAboveThePublishedWorstCase) {
    // docs/math.md, "The irradiance maps": worst error for a sun of flux 1 by M: 0.994, 0.711, 0.266, 0.074. The bound
    // adds 2 %.
    const EnvironmentMap map = testing::one_texel_sun(256, 100, 50, {1, 1, 1});
    const std::pair<int, double> published[] = {{4, 0.994}, {8, 0.711}, {16, 0.266}, {32, 0.074}};
    for (const auto& [m, worst] : published) {
        IrradianceSettings settings;
        settings.specular_maps = m + 1;
        const IrradianceMaps maps = bake(map, settings);
        EXPECT_GT(maps.interpolation_bound.x, 0.99 * worst);
        EXPECT_LT(maps.interpolation_bound.x, 1.04 * worst);
        settings.method = IrradianceMethod::sh;
        EXPECT_GT(bake(map, settings).interpolation_bound.x, 0.99 * worst);
    }
}

TEST(InterpolationBound, NoTangentAndViewExceedIt) {
    // Truth by summing the lit texels directly; tangents anywhere, not only at texels.
    Random random(1);
    for (const int m : {4, 16}) {
        EnvironmentMap map = testing::make_map(64, [](const Vec3d&) { return Vec3d(); });
        for (int k = 0; k < 30; ++k)
            map.pixels[std::size_t(random.next() * 2048)] = Vec3f(Vec3d{random.next(), random.next(), 1} * 100.0);
        IrradianceSettings settings;
        settings.specular_maps = m + 1;
        settings.face_size = 16;
        const Vec3d bound = bake(map, settings).interpolation_bound;
        std::vector<Vec3d> directions, fluxes;
        const LatLongRows rows = latlong_rows(64, 32);
        for (std::size_t i = 0; i < 2048; ++i)
            if (map.pixels[i].z > 0) {
                directions.push_back(direction_of(map, {double(i % 64) + 0.5, double(i / 64) + 0.5}));
                fluxes.push_back(Vec3d(map.pixels[i]) * rows.solid_angle[i / 64]);
            }
        const auto truth = [&](const Vec3d& t, double theta) {
            Vec3d sum;
            for (std::size_t i = 0; i < directions.size(); ++i)
                sum += fluxes[i] * kajiya_kay_specular(std::acos(dot(t, directions[i])), theta, 64);
            return sum;
        };
        double closest = 0;
        for (int k = 0; k < 4000; ++k) {
            const Vec3d t = random_direction(random);
            const int low = int(random.next() * m);
            const double f = random.next(), spacing = pi / m;
            const Vec3d error =
                truth(t, low * spacing) * (1 - f) + truth(t, (low + 1) * spacing) * f - truth(t, (low + f) * spacing);
            for (int c = 0; c < 3; ++c) {
                ASSERT_LE(std::abs(error[c]), bound[c]);
                closest = std::max(closest, std::abs(error[c]) / bound[c]);
            }
        }
        EXPECT_GT(closest, 0.1);  // a bound, not a platitude
    }
}

}  // namespace
}  // namespace hairbake
