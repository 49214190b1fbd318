#include "core/reference/tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/visibility/direction_set.h"
#include "tests/core/reference/trace.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

/// What a probe at the origin sees through one strand in the direction of +x: 1 - opacity for one crossing, and so on.
float seen_along_x(const std::vector<Vec3d>& strand, double width, double opacity) {
    StrandModel model;
    model.add(strand, width, opacity);
    const auto probe = model.add_probes({{0, 0, 0}});
    return trace(model.geometry(), {probe}, {{1, 0, 0}})[0];
}

TEST(TracedTransmittance, OfALoneStraightStrandIsOneHoweverShortItsSegments) {
    // Nothing of a convex body stands between a point inside it and a light outside but the body itself, and a strand
    // does not shadow its own vertices through its own thickness: 1, exactly. Directions along the strand and nearly so
    // stay inside for many segments; segments much shorter than the width lie around the vertex.
    for (const double segment : {0.05, 0.2, 0.4, 0.6, 1.0, 3.0, 30.0})
        for (const Vec3d& axis : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1), normalized(Vec3d(1, 2, 3))})
            for (const double opacity : {1.0, 0.5}) {
                StrandModel model;
                model.add(straight(axis * (-10 * segment), axis * (10 * segment), 20), 1, opacity);
                const StrandGeometry strands = model.geometry();
                auto directions = make_directions(DirectionSet::fibonacci, 1024, 0);
                for (const double tilt : {0.0, 1e-4, 0.01, 0.1})
                    for (const double sign : {1.0, -1.0})
                        directions.push_back(normalized(axis * sign + Vec3d(tilt, -tilt, tilt)));
                for (const float a : trace(strands, all_vertices(strands), directions))
                    EXPECT_EQ(a, 1) << "segments of " << segment << " widths";
            }
}

TEST(TracedTransmittance, OfAStraightStrandOfManyClosePointsIsOne) {
    // 20,000 points a fiftieth of the width apart: rounding of their positions is 1e-5 of the width, so that neighbours
    // are not in line. And five points 1e-5 of a unit apart in the middle of a strand.
    StrandModel dense;
    dense.add(straight({0.3, 0.1, -0.2}, {4.3, 0.1, -0.2}, 20000), 0.01);
    StrandModel near;
    near.add({{0, 0, 0}, {0, 1, 0}, {0, 1.00001, 0}, {0, 1.00002, 0}, {0, 1.00003, 0}, {0, 1.00004, 0}, {0, 2, 0}},
             0.01);
    const auto directions = make_directions(DirectionSet::fibonacci, 256, 0);
    for (const StrandModel* model : {&dense, &near}) {
        const StrandGeometry strands = model->geometry();
        std::vector<std::uint32_t> vertices;
        for (std::uint32_t v = 0; v<strands.vertex_count(); v += strands.vertex_count()> 100 ? 97 : 1)
            vertices.push_back(v);
        for (const float a : trace(strands, vertices, directions)) ASSERT_EQ(a, 1);
    }
}

TEST(TracedTransmittance, DistantLoopsOfACurlBlock) {
    // A helix of radius R = 30 widths and a pitch of 4 widths: a vertex sees the neighbouring turns. Its own turn
    // within 8 widths does not count; the turn above and the one below, 120 widths and more along the strand, do. In
    // the cylinder's tangent plane they are bars of the width w at the distances 4 w, 8 w, ... to both sides, which
    // hide asin(w / 2d) / pi each of the circle across them, 0.08 for the nearest pair alone.
    StrandModel model;
    std::vector<Vec3d> points;
    constexpr int turns = 11, steps = 96;
    for (int i = 0; i <= turns * steps; ++i) {
        const double phi = 2 * std::numbers::pi * i / steps;
        points.emplace_back(30 * std::cos(phi), 30 * std::sin(phi), 4.0 * i / steps);
    }
    model.add(points, 1);
    const auto a = trace(model.geometry(), {turns * steps / 2}, make_directions(DirectionSet::fibonacci, 2048, 0))[0];
    EXPECT_LT(a, 1 - 0.08);
    EXPECT_GT(a, 0.5);
}

TEST(TracedTransmittance, OfADegenerateJointInAStraightStrandIsOne) {
    StrandModel model;
    model.add({{-2, 0, 0}, {-1, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 0}}, 0.2);
    const StrandGeometry strands = model.geometry();
    ASSERT_EQ(strands.degenerate_segment_count, 3u);
    for (const float a : trace(strands, all_vertices(strands), make_directions(DirectionSet::fibonacci, 1024, 0)))
        EXPECT_EQ(a, 1);
}

TEST(TracedTransmittance, OfStrandsOfOnePointIsOne) {
    StrandModel model;
    model.add({{0, 0, 0}}, 0.5);
    model.add({{0.1, 0, 0}}, 0.5);
    model.add({{0, 1, 0}, {0, 1, 0}}, 0.5);  // all its segments are degenerate
    const StrandGeometry strands = model.geometry();
    for (const float a : trace(strands, all_vertices(strands), make_directions(DirectionSet::fibonacci, 100, 0)))
        EXPECT_EQ(a, 1);
}

TEST(TracedTransmittance, OfTwoCrossingThinStrandsIsTheLuneThatTheOtherHides) {
    // A straight strand of radius r and half length h at distance d hides the directions within asin(r/d) of a plane
    // and below the latitude atan(h/d): the share asin(r/d)/pi * h/sqrt(h^2 + d^2). Its round ends add at most two half
    // discs of the solid angle pi r^2/2 * d/D^3, D^2 = h^2 + d^2, over 4 pi: r^2 d / (4 D^3). A sum of 16 x 4,096
    // stratified directions is at least as exact as one of independent ones: sigma = sqrt(p (1 - p) / 65,536).
    const auto directions = many_directions(16);
    for (const auto [r, d, h] : {std::array{0.01, 0.2, 1.0}, {0.01, 0.05, 1.0}, {0.02, 1.0, 0.7}, {0.05, 0.1, 2.0}}) {
        StrandModel model;
        const auto first = model.add(straight({-1, 0, 0}, {1, 0, 0}, 2), 2 * r);
        model.add(straight({0, -h, d}, {0, h, d}, 7), 2 * r);
        const double far = std::sqrt(h * h + d * d), hidden = std::asin(r / d) / std::numbers::pi * h / far;
        const double sigma = std::sqrt(hidden * (1 - hidden) / 65536.0), ends = r * r * d / (4 * far * far * far);
        EXPECT_NEAR(trace(model.geometry(), {first + 1}, directions)[0], 1 - hidden - ends / 2, 4 * sigma + ends / 2)
            << "r " << r << " d " << d << " h " << h;
    }
}

TEST(TracedTransmittance, TakesOneMinusOpacityOfWhatAnOpaqueStrandHides) {
    // The same rays hit: 1 - A(o) = o (1 - A(1)), but for rounding of sums of 4,096 floats.
    const auto directions = many_directions(1);
    const auto hidden = [&](double opacity) {
        StrandModel model;
        const auto first = model.add(straight({-1, 0, 0}, {1, 0, 0}, 2), 0.05, opacity);
        model.add(straight({0, -1, 0.1}, {0, 1, 0.1}, 31), 0.05, opacity);
        return 1 - trace(model.geometry(), {first + 1}, directions)[0];
    };
    for (const double opacity : {0.0, 0.25, 0.5, 0.999}) EXPECT_NEAR(hidden(opacity), opacity * hidden(1), 1e-6);
}

TEST(TracedTransmittance, CountsAStraightStrandOnceWhereverTheRayCrossesIt) {
    // Joints every 1, 0.3, ..., 0.02 widths; crossings at and around a joint, upright and oblique.
    for (const double segment : {3.0, 1.0, 0.5, 0.3, 0.1, 0.02})
        for (const double slope : {0.0, 1.0, 5.0})
            for (const double offset : {-0.5, -0.01, -1e-4, 0.0, 1e-4, 0.01, 0.3}) {
                const double step = segment / std::sqrt(1 + slope * slope);
                const Vec3d middle(20, 0.1, offset * step), along(slope * step, 0, step);
                EXPECT_NEAR(seen_along_x(straight(middle - along * 20, middle + along * 20, 40), 1, 0.3), 0.7, 1e-6)
                    << "segments of " << segment << ", slope " << slope << ", offset " << offset;
            }
}

TEST(TracedTransmittance, CountsAStraightStrandOnceAtADegenerateJoint) {
    for (const double offset : {-0.2, -0.01, 0.0, 0.01, 0.2})
        EXPECT_NEAR(
            seen_along_x({{5, 0, offset - 3}, {5, 0, offset}, {5, 0, offset}, {5, 0, offset}, {5, 0, offset + 3}}, 1,
                         0.3),
            0.7, 1e-6)
            << offset;
}

TEST(TracedTransmittance, CountsTwiceAStrandThatTheRayCrossesTwice) {
    // A hairpin of two legs three widths apart; a zigzag of two segments, which share a joint far from the ray; and
    // a semicircle of many short segments.
    EXPECT_NEAR(seen_along_x({{5, -3, 0}, {5, 3, 0}, {8, 3, 0}, {8, -3, 0}}, 1, 0.3), 0.49, 1e-6);
    EXPECT_NEAR(seen_along_x({{5, -3, 0}, {9, 9, 0}, {13, -3, 0}}, 1, 0.3), 0.49, 1e-6);
    std::vector<Vec3d> arc;
    for (int k = 0; k <= 200; ++k) {
        const double angle = std::numbers::pi * (k / 200.0 - 0.25);
        arc.push_back({10 + 4 * std::cos(angle), 4 * std::sin(angle), 0});
    }
    arc.insert(arc.end(), {{5, 1, 0}, {5.5, -3, 0}});
    EXPECT_NEAR(seen_along_x(arc, 0.5, 0.3), 0.49, 1e-6);
}

TEST(TracedTransmittance, MultipliesOverStrands) {
    StrandModel model;
    for (int k = 1; k <= 9; ++k) model.add(straight({2.0 * k, -1, 0}, {2.0 * k, 1, 0}, 3), 1, 0.1 * k);
    const auto probe = model.add_probes({{0, 0.2, 0}});
    // 0.9 0.8 ... 0.1 = 9! / 10^9
    EXPECT_NEAR(trace(model.geometry(), {probe}, {{1, 0, 0}})[0], 362880e-9, 1e-9);
}

TEST(TracedTransmittance, IsZeroInsideAnotherOpaqueStrand) {
    StrandModel model;
    model.add(straight({-1, 0, 0}, {1, 0, 0}), 0.5);
    const auto probe = model.add_probes({{0, 0.1, 0}});
    EXPECT_EQ(trace(model.geometry(), {probe}, make_directions(DirectionSet::fibonacci, 100, 0))[0], 0);
}

/// Sixty random strands of five points in a cube of side 2.
StrandModel thicket(double opacity) {
    Random random(5);
    StrandModel model;
    for (int s = 0; s < 60; ++s) {
        std::vector<Vec3d> points{random_point_in_ball(random, 1)};
        for (int k = 0; k < 4; ++k) points.push_back(points.back() + random_direction(random) * 0.3);
        model.add(points, 0.04, opacity);
    }
    return model;
}

TEST(TracedTransmittance, IsTheSameAtAnyScale) {
    // The scene's geometry is scaled by a power of two before Embree sees it, so only the rounding of the scaled
    // positions remains: a ray flips with a probability of 1e-6 or so, and a flip is worth 1/512.
    const StrandModel model = thicket(1);
    const auto directions = make_directions(DirectionSet::fibonacci, 512, 0);
    const StrandGeometry plain = model.geometry();
    const auto expected = trace(plain, all_vertices(plain), directions);
    for (const double scale : {1e-15, 1e-6, 1e-3, 1e3, 1e6, 1e15}) {
        const StrandGeometry scaled = model.geometry([&](const Vec3d& p) { return p * scale; }, scale);
        const auto a = trace(scaled, all_vertices(scaled), directions);
        int differ = 0;
        for (std::size_t v = 0; v < a.size(); ++v) {
            differ += a[v] != expected[v];
            EXPECT_NEAR(a[v], expected[v], 2.0 / 512) << "scale " << scale;
        }
        EXPECT_LE(differ, 6) << "of " << a.size() << " at scale " << scale;
    }
}

TEST(TracedTransmittance, TurnsAndMovesWithTheModelAndItsDirections) {
    const StrandModel model = thicket(0.5);
    const auto directions = make_directions(DirectionSet::fibonacci, 512, 0);
    const StrandGeometry plain = model.geometry();
    const auto expected = trace(plain, all_vertices(plain), directions);
    const auto turn = rotation({1, -2, 0.5}, 1.234);
    const StrandGeometry moved = model.geometry([&](const Vec3d& p) { return turn(p) + Vec3d(8, -16, 4); });
    std::vector<Vec3d> turned;
    for (const Vec3d& l : directions) turned.push_back(turn(l));
    const auto a = trace(moved, all_vertices(moved), turned);
    // Positions of up to 16 are rounded by up to 1e-6, 1/40,000 of a width of 0.04: per vertex some 100 of the 512 rays
    // meet a strand, so that 100 x 2 edges x 1e-6 / 0.04 = 0.005 of a ray flips, worth 0.5/512 each.
    double sum = 0;
    for (std::size_t v = 0; v < a.size(); ++v) {
        sum += std::abs(a[v] - expected[v]);
        EXPECT_NEAR(a[v], expected[v], 3 * 0.5 / 512);
    }
    EXPECT_LE(sum / static_cast<double>(a.size()), 0.05 * 0.5 / 512);
}

TEST(TracedTransmittance, IsTheSameForAnyNumberOfThreads) {
    for (const double opacity : {1.0, 0.4}) {
        const StrandGeometry strands = thicket(opacity).geometry();
        const auto directions = make_directions(DirectionSet::fibonacci, 100, 0);
        std::vector<float> one;
        with_threads(1, [&] { one = trace(strands, all_vertices(strands), directions); });
        for (const int threads : {2, 7})
            with_threads(threads, [&] { EXPECT_EQ(trace(strands, all_vertices(strands), directions), one); });
    }
}

TEST(TracedTransmittance, DoesNotDependOnWhichVerticesShareAPacket) {
    const StrandGeometry strands = thicket(0.4).geometry();
    const auto directions = make_directions(DirectionSet::fibonacci, 100, 0);
    const auto all = trace(strands, all_vertices(strands), directions);
    for (const std::uint32_t v : {0u, 15u, 16u, 17u, 299u}) EXPECT_EQ(trace(strands, {v}, directions)[0], all[v]);
    EXPECT_TRUE(trace(strands, {}, directions).empty());
}

TEST(TracedTransmittance, StopsWhenItIsCancelled) {
    const StrandGeometry strands = thicket(1).geometry();
    Progress progress, cancelled;
    cancelled.cancel();
    const StrandScene scene(strands, progress);
    const auto vertices = all_vertices(strands);
    const auto directions = make_directions(DirectionSet::fibonacci, 100, 0);
    try {
        trace_transmittance(scene, vertices, directions, cancelled);
        ADD_FAILURE() << "went on";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
    }
    try {
        const StrandScene never(strands, cancelled);
        trace_transmittance(never, vertices, directions, cancelled);
        ADD_FAILURE() << "went on";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
    }
}

TEST(TracedTransmittance, SurvivesModelsThatHoldNothing) {
    const auto directions = make_directions(DirectionSet::fibonacci, 9, 0);
    EXPECT_TRUE(trace(StrandModel().geometry(), {}, directions).empty());
    StrandModel point;
    point.add({{1, 2, 3}}, 1);
    EXPECT_EQ(trace(point.geometry(), {0}, directions)[0], 1);
    StrandModel heap;
    for (int s = 0; s < 5; ++s) heap.add(std::vector<Vec3d>(4, Vec3d(7, 7, 7)), 1);
    const StrandGeometry strands = heap.geometry();
    for (const float a : trace(strands, all_vertices(strands), directions)) EXPECT_EQ(a, 1);
}

TEST(TracedTransmittance, SurvivesExtentsFarFromTheOrigin) {
    // At 1e7 floats are one apart: the strands degrade to steps, but A stays a share.
    const StrandModel model = thicket(1);
    const StrandGeometry far = model.geometry([](const Vec3d& p) { return p * 20.0 + Vec3d(1e7, -1e7, 1e7); });
    for (const float a : trace(far, all_vertices(far), make_directions(DirectionSet::fibonacci, 64, 0))) {
        EXPECT_GE(a, 0);
        EXPECT_LE(a, 1);
    }
}

}  // namespace
}  // namespace hairbake
