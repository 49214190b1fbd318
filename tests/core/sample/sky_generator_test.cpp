#include "core/sample/sky_generator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/environment/latlong.h"

namespace hairbake {
namespace {

struct Facts {
    double mean = 0, peak = 0, share_above_30 = 0;  // of the green channel; share of the flux in texels above 30 x mean
};

Facts facts_of(const EnvironmentMap& map) {
    const LatLongRows rows = latlong_rows(map.width, map.height);
    Facts facts;
    for (std::size_t i = 0; i < map.pixels.size(); ++i) {
        facts.mean += map.pixels[i].y * rows.solid_angle[i / map.width] / (4 * std::numbers::pi);
        facts.peak = std::max(facts.peak, double(map.pixels[i].y));
    }
    for (std::size_t i = 0; i < map.pixels.size(); ++i)
        if (map.pixels[i].y > 30 * facts.mean)
            facts.share_above_30 +=
                map.pixels[i].y * rows.solid_angle[i / map.width] / (4 * std::numbers::pi) / facts.mean;
    return facts;
}

TEST(SkyGenerator, TheSunIsTensOfThousandsOfTimesTheMean) {
    for (const std::uint64_t seed : {1, 2, 3}) {
        const Facts facts = facts_of(generate_sky(Sky::sunny, 1024, seed));
        // The disc's radiance 9e4 * 0.92 over a mean between 0.5 and 2.
        EXPECT_GT(facts.peak / facts.mean, 3e4);
        EXPECT_GT(facts.share_above_30, 0.4);
        EXPECT_LT(facts.share_above_30, 0.8);
    }
}

TEST(SkyGenerator, StudioLampsAreSmallAndHoldMuchOfTheLightAndOvercastHasNone) {
    for (const std::uint64_t seed : {1, 2, 3}) {
        EXPECT_GT(facts_of(generate_sky(Sky::studio, 512, seed)).share_above_30, 0.3);
        // Real overcast maps stay below 20 x mean (shared data); CIE's own contrast is 3.
        EXPECT_LT(facts_of(generate_sky(Sky::overcast, 1024, seed)).peak,
                  10 * facts_of(generate_sky(Sky::overcast, 1024, seed)).mean);
    }
}

TEST(SkyGenerator, ASeedIsTheSameSceneAtEverySize) {
    for (const Sky sky : {Sky::sunny, Sky::studio, Sky::overcast}) {
        const double large = facts_of(generate_sky(sky, 1024, 5)).mean;
        // Lamps keep their flux exactly but for the texel's solid angle being that of its row (exact) and patches being
        // dealt whole; the background is sampled at centres: noise of 512 texels' clouds, about 2 %.
        for (const int width : {64, 256})
            EXPECT_NEAR(facts_of(generate_sky(sky, width, 5)).mean / large, 1, 0.04) << width;
    }
}

TEST(SkyGenerator, SeedsDifferAndThreadsDoNotChangeABit) {
    EnvironmentMap maps[3];
    const int threads[] = {1, 2, 7};
    for (int k = 0; k < 3; ++k) with_threads(threads[k], [&] { maps[k] = generate_sky(Sky::sunny, 128, 6); });
    EXPECT_EQ(maps[0].pixels, maps[1].pixels);
    EXPECT_EQ(maps[0].pixels, maps[2].pixels);
    EXPECT_NE(maps[0].pixels, generate_sky(Sky::sunny, 128, 7).pixels);
}

TEST(SkyGenerator, EveryPixelIsAPossibleRadianceAndSizesAreChecked) {
    for (const Sky sky : {Sky::sunny, Sky::studio, Sky::overcast})
        for (const Vec3f& p : generate_sky(sky, 512, 8).pixels)
            ASSERT_TRUE(is_finite(p) && p.x >= 0 && p.y >= 0 && p.z >= 0);
    for (const int width : {0, 14, 33, 4098}) EXPECT_THROW(generate_sky(Sky::sunny, width, 1), Error) << width;
}

}  // namespace
}  // namespace hairbake
