// The reference with an occluder, against solid angles in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/mesh/grounding.h"
#include "core/visibility/direction_set.h"
#include "tests/core/reference/trace.h"
#include "tests/support/mesh_models.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

/// A kink at a horizon costs a Fibonacci set of 4,096 directions about 0.4 N^-3/4 = 0.0008.
constexpr double quadrature = 0.002;

std::vector<float> trace_under(const StrandGeometry& strands, const TriangleMesh& occluder,
                               const std::vector<Vec3d>& directions) {
    Progress progress;
    const StrandScene scene(strands, progress, &occluder);
    return trace_transmittance(scene, all_vertices(strands), directions, progress);
}

/// A of lone points in a box of size 2, so that points count as on the surface from 0.0004 above it to 0.0078 below.
std::vector<float> seen_from(const std::vector<Vec3d>& points, const TriangleMesh& occluder) {
    StrandModel model;
    model.add_probes(points);
    model.add_box({-1, -1, -1}, {1, 1, 1});
    return trace_under(model.geometry(), occluder, make_directions(DirectionSet::fibonacci, 4096, 0));
}

TEST(TracedOccluder, ADiscBlocksItsSolidAngleFromBothSides) {
    // (1 - d / sqrt(d^2 + R^2)) / 2; the fan of 256 sides lacks 1e-4 of the disc.
    for (const double radius : {0.3, 1.0, 1000.0})
        for (const double d : {0.01, 0.2, 0.7}) {
            const auto seen = seen_from({{0, d, 0}, {0, -d, 0}}, disc_mesh(0, radius, 256));
            const double blocked = (1 - d / std::sqrt(d * d + radius * radius)) / 2;
            for (const int side : {0, 1})
                EXPECT_NEAR(seen[static_cast<std::size_t>(side)], 1 - blocked, quadrature) << radius << " " << d;
        }
}

TEST(TracedOccluder, ABallBlocksItsSolidAngle) {
    // (1 - sqrt(1 - (R/D)^2)) / 2; facets of 128 rings lie at most 7.5e-5 R inside the sphere.
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 0.3, 128);
    for (const double distance : {0.31, 0.4, 0.9}) {
        const double blocked = (1 - std::sqrt(1 - 0.09 / (distance * distance))) / 2;
        const auto seen = seen_from({{distance, 0, 0}, {0, -distance, 0}, {0, 0, distance}}, ball);
        for (const std::size_t k : {0, 1, 2}) EXPECT_NEAR(seen[k], 1 - blocked, quadrature) << distance;
    }
}

TEST(TracedOccluder, APointOnTheSurfaceOrALittleBelowItSeesTheHalfSpace) {
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 0.5, 32), disc = disc_mesh(0, 1000, 64);
    for (const double depth : {0.0, 1e-4, 0.003, 0.007}) {
        const Vec3d on_facet(normalized(Vec3d(0.3, 0.5, 0.2)) * (0.499 - depth));
        const auto ball_seen = seen_from({Vec3d(ball.positions[700]) * (1 - 2 * depth), on_facet}, ball);
        for (const int k : {0, 1}) EXPECT_NEAR(ball_seen[static_cast<std::size_t>(k)], 0.5, quadrature) << depth;
        EXPECT_NEAR(seen_from({{0.1, -depth, 0.2}}, disc)[0], 0.5, quadrature) << depth;
    }
    // A shell that faces down is stood on from below, and still blocks the light from above.
    EXPECT_NEAR(seen_from({{0.1, 0, 0.2}}, turned_round(disc))[0], 0.5, quadrature);
}

TEST(TracedOccluder, APointDeepInsideAClosedMeshSeesNothing) {
    for (const bool turned : {false, true}) {
        const TriangleMesh ball = ball_mesh({0, 0, 0}, 0.5, 32);
        const auto seen = seen_from({{0, 0, 0}, {0.3, 0.3, 0}, {0, 0.48, 0}}, turned ? turned_round(ball) : ball);
        for (const std::size_t k : {0, 1, 2}) EXPECT_EQ(seen[k], 0);
    }
}

TEST(TracedOccluder, BlocksWhatTheHairLetsThrough) {
    // For every single direction: the hair's transmittance where the occluder is not in the way, else 0.
    Random random(5);
    StrandModel model;
    for (int s = 0; s < 30; ++s) {
        const Vec3d p = random_point_in_ball(random, 0.8);
        model.add(straight(p, p + random_direction(random) * 0.5, 3), 0.05, 0.4);
    }
    const StrandGeometry strands = model.geometry();
    const TriangleMesh ball = ball_mesh({0.2, -0.4, 0}, 0.4, 24);
    StrandModel bare;  // the same points without hair
    for (const Vec3f& p : strands.positions) bare.add_probes({Vec3d(p)});
    int blocked = 0, open = 0;
    for (const Vec3d& l : make_directions(DirectionSet::fibonacci, 50, 0)) {
        const auto with = trace_under(strands, ball, {l}), hair = trace(strands, all_vertices(strands), {l});
        const auto past = trace_under(bare.geometry(), ball, {l});
        for (std::size_t v = 0; v < with.size(); ++v) {
            EXPECT_EQ(with[v], hair[v] * past[v]);
            ++(past[v] > 0 ? open : blocked);
        }
    }
    EXPECT_GT(blocked, 1000);
    EXPECT_GT(open, 1000);
}

TEST(TracedOccluder, FarFromEverythingItChangesNothing) {
    StrandModel model;
    model.add(straight({0, 0, 0}, {1, 0, 0}, 9), 0.05, 0.5);
    model.add(straight({0.4, -1, 0.1}, {0.4, 1, 0.1}, 9), 0.05, 0.5);
    const StrandGeometry strands = model.geometry();
    const auto directions = make_directions(DirectionSet::fibonacci, 500, 0);
    EXPECT_EQ(trace_under(strands, ball_mesh({1e6, 0, 0}, 1, 6), directions),
              trace(strands, all_vertices(strands), directions));
}

TEST(TracedOccluder, IsTheSameForAnyNumberOfThreads) {
    Random random(6);
    StrandModel model;
    for (int s = 0; s < 200; ++s) {
        const Vec3d p = random_direction(random) * 0.5;
        model.add(straight(p, p * 1.6, 4), 0.01);
    }
    const StrandGeometry strands = model.geometry();
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 0.5, 24);
    const auto directions = make_directions(DirectionSet::fibonacci, 64, 0);
    const auto expected = trace_under(strands, ball, directions);
    for (const int threads : {1, 2, 7})
        with_threads(threads, [&] { EXPECT_EQ(trace_under(strands, ball, directions), expected); });
}

}  // namespace
}  // namespace hairbake
