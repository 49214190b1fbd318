// The volume method with an occluder, against solid angles in closed form and against the tracer.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/reference/error_bar.h"
#include "core/reference/tracer.h"
#include "core/visibility/direction_set.h"
#include "core/volume/transmittance.h"
#include "tests/support/mesh_models.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

std::vector<float> bake_under(const StrandGeometry& strands, const TriangleMesh& occluder,
                              const TransmittanceSettings& settings = {}) {
    Progress progress;
    return bake_transmittance_volume({strands, &occluder}, settings, progress).average;
}

/// A kink at a horizon costs a Fibonacci set of 256 directions about 0.4 N^-3/4 = 0.006.
constexpr double quadrature = 0.008;
/// Cells of the shadow in the box below: half of one is the outline's error in one direction.
constexpr double cell = 2.0 / 512;

/// A of lone points in a box of size 2.
std::vector<float> seen_from(const std::vector<Vec3d>& points, const TriangleMesh& occluder, int voxels = 32) {
    StrandModel model;
    model.add_probes(points);
    model.add_box({-1, -1, -1}, {1, 1, 1});
    return bake_under(model.geometry(), occluder, with_voxels(voxels, 256));
}

TEST(Occluder, ADiscBlocksItsSolidAngleFromBothSides) {
    // p(R) = (1 - d / sqrt(d^2 + R^2)) / 2; half a cell more or less of R: p' = d R / (2 (d^2 + R^2)^1.5).
    for (const double radius : {0.3, 1000.0})
        for (const double d : {0.01, 0.5}) {
            const auto seen = seen_from({{0, d, 0}, {0, -d, 0}}, disc_mesh(0, radius, 256));
            const double far = std::sqrt(d * d + radius * radius), blocked = (1 - d / far) / 2;
            const double outline = d * radius / (2 * far * far * far) * cell / 2;
            for (const int side : {0, 1})
                EXPECT_NEAR(seen[static_cast<std::size_t>(side)], 1 - blocked, quadrature + outline)
                    << radius << " " << d;
        }
}

TEST(Occluder, ABallBlocksItsSolidAngleWhateverTheVoxels) {
    // p(R) = (1 - sqrt(1 - (R/D)^2)) / 2; half a cell more or less of R: p' = R / (2 D^2 sqrt(1 - (R/D)^2)).
    const double radius = 0.3;
    const TriangleMesh ball = ball_mesh({0, 0, 0}, radius, 64);
    for (const int voxels : {32, 256})
        for (const double distance : {0.31, 0.4, 0.9}) {
            const double root = std::sqrt(1 - radius * radius / (distance * distance));
            const double outline = radius / (2 * distance * distance * root) * cell / 2;
            const auto seen = seen_from({{distance, 0, 0}, {0, -distance, 0}, {0, 0, distance}}, ball, voxels);
            for (const std::size_t k : {0, 1, 2})
                EXPECT_NEAR(seen[k], (1 + root) / 2, quadrature + outline) << distance;
        }
}

TEST(Occluder, APointOnTheSurfaceOrALittleBelowItSeesTheHalfSpace) {
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 0.5, 32), disc = disc_mesh(0, 1000, 64);
    for (const double depth : {0.0, 0.005}) {
        const Vec3d on_facet(normalized(Vec3d(0.3, 0.5, 0.2)) * (0.499 - depth));
        const auto ball_seen = seen_from({Vec3d(ball.positions[700]) * (1 - 2 * depth), on_facet}, ball);
        for (const int k : {0, 1}) EXPECT_NEAR(ball_seen[static_cast<std::size_t>(k)], 0.5, quadrature) << depth;
        EXPECT_NEAR(seen_from({{0.1, -depth, 0.2}}, disc)[0], 0.5, quadrature) << depth;
    }
    EXPECT_NEAR(seen_from({{0.1, 0, 0.2}}, turned_round(disc))[0], 0.5, quadrature);
}

TEST(Occluder, APointDeepInsideAClosedMeshSeesNothing) {
    for (const bool turned : {false, true}) {
        const TriangleMesh ball = ball_mesh({0, 0, 0}, 0.5, 32);
        const auto seen = seen_from({{0, 0, 0}, {0.3, 0.3, 0}, {0, 0.48, 0}}, turned ? turned_round(ball) : ball);
        for (const std::size_t k : {0, 1, 2}) EXPECT_EQ(seen[k], 0);
    }
}

/// Hair on a ball of radius 0.5: `strands` of ten points, 0.6 long.
StrandGeometry hair_on_ball(int strands) {
    Random random(8);
    StrandModel model;
    for (int s = 0; s < strands; ++s) {
        Vec3d up = random_direction(random);
        up.y = std::abs(up.y);
        const Vec3d lean = random_direction(random) * 0.4;
        std::vector<Vec3d> points;
        for (int k = 0; k < 10; ++k) points.push_back(up * (0.5 + 0.06 * k) + lean * (0.006 * k * k));
        model.add(points, 0.0015);
    }
    return model.geometry();
}

TEST(Occluder, OfHairOnABallAgreesWithTheTracedTruth) {
    // The stage's target with an occluder, RMSE 0.03; the roots, a tenth of the vertices, alone as well.
    const StrandGeometry strands = hair_on_ball(3000);
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 0.5, 48);
    const auto baked = bake_under(strands, ball);
    Progress progress;
    const StrandScene scene(strands, progress, &ball);
    const ErrorBar bar = measure_error(scene, baked, 600, 1, progress);
    EXPECT_LT(bar.outside.rmse, 0.03);
    EXPECT_LT(std::abs(bar.outside.bias), 0.015);
    std::vector<std::uint32_t> roots;
    for (std::size_t s = 0; s < strands.strand_count(); s += 10) roots.push_back(strands.strand_begin[s]);
    const auto traced = trace_transmittance(scene, roots, make_directions(DirectionSet::fibonacci, 1024, 0), progress);
    std::vector<float> at_roots;
    for (const std::uint32_t v : roots) at_roots.push_back(baked[v]);
    EXPECT_LT(error_statistics(at_roots, traced).rmse, 0.03);
    EXPECT_GT(std::accumulate(traced.begin(), traced.end(), 0.0f) / static_cast<float>(traced.size()), 0.1f);
}

TEST(Occluder, FarFromEverythingItChangesNoBit) {
    const StrandGeometry strands = hair_on_ball(300);
    EXPECT_EQ(bake_under(strands, ball_mesh({1e6, 1e5, 0}, 1, 6)), bake(strands));
    EXPECT_EQ(bake_under(strands, {}), bake(strands));
}

TEST(Occluder, IsTheSameForAnyNumberOfThreads) {
    const StrandGeometry strands = hair_on_ball(300);
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 0.5, 24);
    const auto expected = bake_under(strands, ball);
    for (const int threads : {1, 2, 7}) with_threads(threads, [&] { EXPECT_EQ(bake_under(strands, ball), expected); });
}

TEST(Occluder, DoesNotChangeTheHairsVoxels) {
    const StrandGeometry strands = hair_on_ball(300);
    const TriangleMesh large = ball_mesh({0, -1000.5, 0}, 1000, 64);
    Progress progress;
    const auto with = bake_transmittance_volume({strands, &large}, {}, progress);
    const auto without = bake_transmittance_volume({strands}, {}, progress);
    EXPECT_EQ(with.voxel_size, without.voxel_size);
    EXPECT_EQ(with.occupied_voxels, without.occupied_voxels);
    for (std::size_t v = 0; v < with.average.size(); ++v) EXPECT_LE(with.average[v], without.average[v] + 0.05f);
}

TEST(Occluder, SurvivesMeshesAndModelsThatHoldNothing) {
    StrandModel lone;
    lone.add_probes({{1, 2, 3}});
    EXPECT_EQ(bake_under(StrandModel().geometry(), disc_mesh(0, 1, 8)).size(), 0u);
    EXPECT_EQ(bake_under(lone.geometry(), {}), std::vector<float>(1, 1));
    TriangleMesh flat;
    flat.positions = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    flat.triangles = {{0, 1, 2}};
    EXPECT_EQ(bake_under(lone.geometry(), flat), std::vector<float>(1, 1));
    const float inside = bake_under(lone.geometry(), ball_mesh({1, 2, 3}, 1e15, 8))[0];
    EXPECT_EQ(inside, 0);
}

TEST(Occluder, StopsWhenItIsCancelled) {
    const StrandGeometry strands = hair_on_ball(10);
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 0.5, 24);
    Progress cancelled;
    cancelled.cancel();
    EXPECT_THROW(bake_transmittance_volume({strands, &ball}, {}, cancelled), Error);
}

}  // namespace
}  // namespace hairbake
