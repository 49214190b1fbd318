// What the tracer gives beside A, against the definitions and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/base/spherical_harmonics.h"
#include "core/visibility/direction_set.h"
#include "tests/core/reference/trace.h"
#include "tests/support/receiver_points.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;
using std::numbers::pi;

StrandGeometry small_ball(double opacity) {
    Random random(21);
    StrandModel model;
    for (int s = 0; s < 150; ++s) {
        const Vec3d root = random_point_in_ball(random, 1);
        model.add(straight(root, root + random_direction(random) * 0.8, 3), 0.02, opacity);
    }
    return model.geometry();
}

TEST(DirectionalTrace, IsTheDefinitionOnTheTransmittanceOfEveryDirection) {
    // T_k traced one direction at a time; floats of at most 4 against doubles: 1e-6, axes and angles of sums of 40:
    // 1e-5.
    const auto directions = make_directions(DirectionSet::fibonacci, 40, 0);
    for (const double opacity : {1.0, 0.4}) {
        const StrandGeometry strands = small_ball(opacity);
        const auto vertices = all_vertices(strands);
        std::vector<std::vector<float>> t;
        for (const Vec3d& w : directions) t.push_back(trace(strands, vertices, {w}));
        Progress progress;
        const StrandScene scene(strands, progress);
        const DirectionalMeans traced = trace_directional(scene, vertices, directions, 3, true, progress);
        ASSERT_EQ(traced.sh.size(), 9 * vertices.size());
        ASSERT_EQ(traced.bent_cone.size(), 4 * vertices.size());
        EXPECT_EQ(traced.average, trace(strands, vertices, directions));
        for (std::size_t v = 0; v < vertices.size(); v += 7) {
            std::vector<double> y(9), c(9);
            Vec3d sum;
            double total = 0;
            for (std::size_t k = 0; k < directions.size(); ++k) {
                ShBasis(3).evaluate(directions[k], y);
                for (std::size_t i = 0; i < 9; ++i) c[i] += 4 * pi / 40 * double(t[k][v]) * y[i];
                sum += directions[k] * double(t[k][v]);
                total += double(t[k][v]);
            }
            for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(traced.sh[9 * v + i], c[i], 2e-6);
            EXPECT_NEAR(traced.average[v], c[0] / (2 * std::sqrt(pi)), 1e-6);
            const float* cone = &traced.bent_cone[4 * v];
            const Vec3d b = sum / total;
            for (int a = 0; a < 3; ++a) EXPECT_NEAR(cone[a], b[a] / length(b), 1e-5);
            EXPECT_NEAR(cone[3], std::acos(2 * length(b) - 1), 1e-4);
        }
    }
}

TEST(DirectionalTrace, GivesTheSameBitsForAnyNumberOfThreads) {
    const StrandGeometry strands = small_ball(0.5);
    const TriangleMesh receiver = receiver_points({{{0, 0, 0}, {0, 0, 1}}, {{2, 0, 0}, {-1, 0, 0}}});
    const auto run = [&](int threads) {
        std::pair<DirectionalMeans, std::vector<float>> result;
        with_threads(threads, [&] {
            Progress progress;
            const StrandScene scene(strands, progress);
            const auto directions = make_directions(DirectionSet::fibonacci, 30, 0);
            result.first = trace_directional(scene, all_vertices(strands), directions, 4, true, progress);
            result.second = trace_receiver(scene, receiver, false, directions, progress);
        });
        return result;
    };
    const auto [one, one_receiver] = run(1);
    const auto [seven, seven_receiver] = run(7);
    EXPECT_EQ(one.sh, seven.sh);
    EXPECT_EQ(one.bent_cone, seven.bent_cone);
    EXPECT_EQ(one_receiver, seven_receiver);
}

/// A sheet of touching strands at z = 0, 20 x 20 around the z axis, opaque.
StrandModel sheet() {
    StrandModel model;
    for (int k = -100; k <= 100; ++k) model.add({{-10, 0.1 * k, 0}, {10, 0.1 * k, 0}}, 0.11);
    return model;
}

TEST(DirectionalTrace, OverAnOpaqueHalfSpaceIsHalfTheSky) {
    // 0.3 above the sheet's middle its edge is 0.03 radians below the horizon: 1.5 % more of the sphere is seen, and
    // the set of 4,096 errs by 0.0035. b: 0.5 (1 - 0.03). c_1 = sqrt(3 pi) / 2 along z, order y, z, x.
    StrandModel model = sheet();
    const auto probe = model.add_probes({{0, 0, 0.3}});
    const StrandGeometry strands = model.geometry();
    Progress progress;
    const StrandScene scene(strands, progress);
    const auto half = trace_directional(scene, std::vector{probe}, make_directions(DirectionSet::fibonacci, 4096, 0), 2,
                                        true, progress);
    EXPECT_NEAR(half.average[0], 0.5, 0.02);
    EXPECT_NEAR(half.sh[0], std::sqrt(pi), 0.06);
    EXPECT_NEAR(half.sh[2], std::sqrt(3 * pi) / 2, 0.03);
    EXPECT_NEAR(half.sh[1], 0, 0.03);
    EXPECT_NEAR(half.sh[3], 0, 0.03);
    EXPECT_NEAR(half.bent_cone[2], 1, 1e-3);
    EXPECT_NEAR(half.bent_cone[3], pi / 2, 0.05);
}

TEST(TracedReceiver, UnderAnOpaqueSheetSeesNothingAndOverItEverything) {
    // 0.3 below the sheet 3 % of the hemisphere look past its edge, where the cosine is below 0.03: 0.1 % of the
    // weight.
    const StrandGeometry strands = sheet().geometry();
    Progress progress;
    const StrandScene scene(strands, progress);
    const TriangleMesh receiver = receiver_points(
        {{{0, 0, -0.3}, {0, 0, 1}}, {{0, 0, -0.3}, {0, 0, -1}}, {{0, 0, 0.3}, {0, 0, 1}}, {{0, 0, 0.3}, {1, 0, 0}}});
    const auto directions = make_directions(DirectionSet::fibonacci, 4096, 0);
    const auto seen = trace_receiver(scene, receiver, false, directions, progress);
    EXPECT_LT(seen[0], 0.035);
    EXPECT_LT(seen[1], 0.003);
    EXPECT_EQ(seen[2], 1);
    EXPECT_EQ(seen[3], 1);
    EXPECT_EQ(seen[4], 1);
    EXPECT_EQ(seen[5], 1);
    EXPECT_NEAR(seen[6], 0.5, 0.025);  // a wall sees the upper half of its hemisphere
    EXPECT_NEAR(seen[7], 0.5, 0.025);
}

TEST(TracedReceiver, IsShadowedByTheOccluderUnlessItIsTheOccluder) {
    StrandModel model;
    model.add({{5, 5, 5}, {5, 5, 5.1}}, 0.001);
    model.add_box(Vec3d(-5), Vec3d(5));
    const StrandGeometry strands = model.geometry();
    const TriangleMesh roof = square(1, 1000),
                       points = receiver_points({{{0, 0, -1}, {0, 0, 1}}, {{0, 0, 3}, {0, 0, 1}}});
    Progress progress;
    const StrandScene scene(strands, progress, &roof);
    const auto directions = make_directions(DirectionSet::fibonacci, 400, 0);
    const auto shadowed = trace_receiver(scene, points, false, directions, progress);
    EXPECT_LT(shadowed[0], 0.005);  // 0.2 % of the hemisphere look past the roof's edge
    EXPECT_LT(shadowed[1], 1e-4);
    EXPECT_EQ(shadowed[2], 1);
    const auto itself = trace_receiver(scene, points, true, directions, progress);
    EXPECT_EQ(itself, std::vector<float>(4, 1));
}

}  // namespace
}  // namespace hairbake
