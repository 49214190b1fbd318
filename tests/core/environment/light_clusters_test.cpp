#include "core/environment/light_clusters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "tests/support/make_map.h"

namespace hairbake {
namespace {

using std::numbers::pi;
using testing::make_map;
using testing::noise_map;

LightSet lights_of(const EnvironmentMap& map) { return make_light_set(map, clustered_resolution, Progress()); }

Vec3d total(const std::vector<ClusteredLight>& clusters) {
    Vec3d sum;
    for (const ClusteredLight& cluster : clusters) sum += cluster.flux;
    return sum;
}

TEST(LightClusters, KeepTheFlux) {
    const LightSet lights = lights_of(noise_map(256, 3, LatLong::gltf, {10, 20, 30}));
    for (const std::size_t count : {1u, 7u, 64u, 181u}) {
        const auto clusters = cluster_lights(lights, count, Progress());
        EXPECT_EQ(clusters.size(), count);
        // The lights' own flux is rounded to single precision: 2^-24 each.
        EXPECT_LT(length(total(clusters) - lights.total), 1e-7 * length(lights.total));
        for (const ClusteredLight& cluster : clusters) EXPECT_NEAR(length(cluster.direction), 1, 1e-12);
    }
}

TEST(LightClusters, ASunHasAClusterOfItsOwn) {
    // Relatives: a sun that lies in one texel, and one that straddles four cells. The sky gives 4 pi, the sun twice that.
    for (const double angle : {0.0, 0.7}) {
        const Vec3d sun = normalized(Vec3d{std::cos(angle), 0.5, std::sin(angle)});
        const double half = 1.2 * pi / 180, flux_of_disk = 2 * pi * (1 - std::cos(half));
        const EnvironmentMap map = make_map(1024, [&](const Vec3d& l) {
            return Vec3d(1 + (dot(l, sun) > std::cos(half) ? 8 * pi / flux_of_disk : 0));
        });
        const auto clusters = cluster_lights(lights_of(map), 64, Progress());
        double near_sun = 0;
        for (const ClusteredLight& cluster : clusters)
            if (dot(cluster.direction, sun) > std::cos(2 * half)) near_sun += cluster.flux.y;
        EXPECT_GT(near_sun, 0.95 * 8 * pi) << angle;  // the disk's rim is as jagged as the texels of .35 degrees
    }
}

TEST(LightClusters, FewerLightsThanClustersStayAsTheyAre) {
    LightSet lights;
    lights.x = {1, 0};
    lights.y = {0, 1};
    lights.z = {0, 0};
    lights.flux = {1, 2, 3, 0, 4, 5, 6, 0};
    const auto clusters = cluster_lights(lights, 64, Progress());
    ASSERT_EQ(clusters.size(), 2u);
    EXPECT_EQ(clusters[1].direction, (Vec3d{0, 1, 0}));
    EXPECT_EQ(clusters[1].flux, (Vec3d{4, 5, 6}));
    EXPECT_TRUE(cluster_lights({}, 64, Progress()).empty());
}

TEST(LightClusters, TwoLampsAreTwoClusters) {
    LightSet lights;
    for (int i = 0; i < 40; ++i) {  // 20 lights within 0.02 of each of two axes
        lights.x.push_back(i < 20 ? 1 : 0.001f * float(i - 30));
        lights.y.push_back(i < 20 ? 0.001f * float(i - 10) : 1);
        lights.z.push_back(0);
        for (const float f : {1.0f, 1.0f, i < 20 ? 1.0f : 3.0f, 0.0f}) lights.flux.push_back(f);
    }
    const auto clusters = cluster_lights(lights, 2, Progress());
    ASSERT_EQ(clusters.size(), 2u);
    const bool swapped = clusters[0].direction.y > 0.5;
    EXPECT_GT(clusters[swapped ? 1 : 0].direction.x, 0.9999);
    EXPECT_EQ(clusters[swapped ? 1 : 0].flux, (Vec3d{20, 20, 20}));
    EXPECT_EQ(clusters[swapped ? 0 : 1].flux, (Vec3d{20, 20, 60}));
}

TEST(LightClusters, AreTheSameForAnyThreadCount) {
    const LightSet lights = lights_of(noise_map(128, 5));
    std::vector<std::vector<ClusteredLight>> results;
    for (const int threads : {1, 2, 7})
        with_threads(threads, [&] { results.push_back(cluster_lights(lights, 64, Progress())); });
    for (std::size_t r = 1; r < results.size(); ++r)
        for (std::size_t k = 0; k < 64; ++k) {
            EXPECT_EQ(results[0][k].direction, results[r][k].direction);
            EXPECT_EQ(results[0][k].flux, results[r][k].flux);
        }
}

}  // namespace
}  // namespace hairbake
