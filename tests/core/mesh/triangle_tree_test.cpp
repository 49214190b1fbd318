#include "core/mesh/triangle_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "tests/support/mesh_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

Vec3d random_point(Random& random, double half) {
    return {random.next(-half, half), random.next(-half, half), random.next(-half, half)};
}

/// Distance from a triangle by looking at many of its points: never below the truth, and above it by at most the step.
double distance_by_points(const TriangleMesh& mesh, std::size_t t, const Vec3d& p, int steps) {
    const Vec3d a(mesh.positions[mesh.triangles[t][0]]), b(mesh.positions[mesh.triangles[t][1]]),
        c(mesh.positions[mesh.triangles[t][2]]);
    double best = 1e30;
    for (int i = 0; i <= steps; ++i)
        for (int j = 0; i + j <= steps; ++j)
            best = std::min(best, length(a + (b - a) * (double(i) / steps) + (c - a) * (double(j) / steps) - p));
    return best;
}

TEST(TriangleTree, AgreesWithLookingAtEveryTriangle) {
    Random random(3);
    TriangleMesh mesh;
    for (std::uint32_t t = 0; t < 60; ++t) {
        const Vec3d at = random_point(random, 1);
        for (int c = 0; c < 3; ++c) mesh.positions.emplace_back(at + random_point(random, 0.3));
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const TriangleTree tree(mesh);
    for (int k = 0; k < 100; ++k) {
        const Vec3d p = random_point(random, 1.2);
        double expected = 1e30;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            expected = std::min(expected, distance_by_points(mesh, t, p, 60));
        const auto nearest = tree.nearest(p, 10);
        ASSERT_TRUE(nearest);
        // The nearest of the points is at most one step of sides up to 1.04 off: 0.017.
        EXPECT_LE(nearest->distance, expected + 1e-12);
        EXPECT_GT(nearest->distance, expected - 0.018);
        EXPECT_NEAR(length(nearest->point - p), nearest->distance, 1e-12);
        EXPECT_EQ(tree.nearest(p, nearest->distance * 0.999).has_value(), false);
    }
}

TEST(TriangleTree, TellsTheSideOfAPointBesideEdgesAndCorners) {
    // Outside a convex mesh every point lies in front of the triangle found, inside behind it, also where the nearest
    // point is an edge or a corner that triangles share.
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 1, 5);
    const TriangleTree tree(ball);
    Random random(4);
    std::vector<Vec3d> directions;
    for (int k = 0; k < 300; ++k) directions.push_back(normalized(random_point(random, 1)));
    for (const Vec3f& corner : ball.positions) directions.emplace_back(corner);
    for (const Vec3d& d : directions) {
        const auto outside = tree.nearest(d * 1.5, 2), inside = tree.nearest(d * 0.5, 2);
        ASSERT_TRUE(outside && inside);
        EXPECT_GT(dot(d * 1.5 - outside->point, outside->normal), 0);
        EXPECT_LT(dot(d * 0.5 - inside->point, inside->normal), 0);
    }
}

TEST(TriangleTree, HoldsNothingButTrianglesWithArea) {
    TriangleMesh mesh;
    EXPECT_FALSE(TriangleTree(mesh).nearest({0, 0, 0}, 1e30));
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    mesh.triangles = {{0, 1, 2}};
    EXPECT_FALSE(TriangleTree(mesh).nearest({0, 0, 0}, 1e30));
}

}  // namespace
}  // namespace hairbake
