#include "core/mesh/grounding.h"

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "tests/support/mesh_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

constexpr ShadowScale unit{1.0};  // reach 1/256 = 0.0039, lift 0.0002

std::vector<GroundedPoint> ground(const std::vector<Vec3f>& points, const TriangleMesh& mesh) {
    Progress progress;
    return ground_points(points, mesh, unit, progress);
}

TEST(Grounding, TakesPointsOnTheSurfaceAndALittleBelowItAndLiftsThem) {
    const TriangleMesh disc = disc_mesh(0, 1, 12);
    const std::vector<Vec3f> points{{0.1f, 0.001f, 0.2f},  {0.1f, 0.0001f, 0.2f}, {0.1f, 0, 0.2f},
                                    {0.1f, -0.003f, 0.2f}, {0.1f, -0.005f, 0.2f}, {3, 0, 0}};
    const auto grounded = ground(points, disc);
    ASSERT_EQ(grounded.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(grounded[k].point, k + 1);
        EXPECT_LT(length(grounded[k].origin - Vec3f(0.1f, 0.0002f, 0.2f)), 1e-7f);
        EXPECT_LT(length(grounded[k].normal - Vec3f(0, 1, 0)), 1e-6f);
    }
    // A shell's outside is where its triangles run counter-clockwise.
    const auto below = ground(points, turned_round(disc));
    ASSERT_EQ(below.size(), 3u);
    EXPECT_EQ(below[0].point, 0u);
    EXPECT_LT(below[0].normal.y, -0.99f);
}

TEST(Grounding, AClosedMeshMayBeInsideOut) {
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 1, 32);
    const std::vector<Vec3f> points(ball.positions.begin(), ball.positions.begin() + 40);
    const auto grounded = ground(points, ball), turned = ground(points, turned_round(ball));
    ASSERT_EQ(grounded.size(), points.size());
    ASSERT_EQ(turned.size(), points.size());
    for (std::size_t k = 0; k < points.size(); ++k)
        for (const auto* g : {&grounded[k], &turned[k]}) EXPECT_GT(dot(g->normal, points[k]), 0.9f);
}

TEST(Grounding, IsTheSameForAnyNumberOfThreads) {
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 1, 20);
    Random random(2);
    std::vector<Vec3f> points;
    for (int k = 0; k < 20000; ++k)
        points.emplace_back(normalized(Vec3d(random.next(-1, 1), random.next(-1, 1), random.next(-1, 1))) *
                            random.next(0.99, 1.001));
    const auto expected = ground(points, ball);
    EXPECT_GT(expected.size(), 1000u);
    for (const int threads : {1, 2, 7})
        with_threads(threads, [&] {
            const auto found = ground(points, ball);
            ASSERT_EQ(found.size(), expected.size());
            for (std::size_t k = 0; k < found.size(); ++k) {
                EXPECT_EQ(found[k].point, expected[k].point);
                EXPECT_EQ(found[k].origin, expected[k].origin);
            }
        });
}

TEST(Grounding, ItsLengthsFollowTheHairThenTheMesh) {
    const TriangleMesh disc = disc_mesh(0, 2, 12);
    EXPECT_EQ(shadow_scale(std::vector<Vec3f>{{0, 0, 0}, {1, 3, 2}}, disc).size, 3);
    EXPECT_NEAR(shadow_scale(std::vector<Vec3f>{{1, 1, 1}}, disc).size, 4, 1e-6);
    EXPECT_EQ(shadow_scale({}, {}).size, 1);
}

}  // namespace
}  // namespace hairbake
