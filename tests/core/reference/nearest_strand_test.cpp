#include "core/reference/nearest_strand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"
#include "tests/core/reference/trace.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

TEST(DistanceToOtherStrands, IsFromTheSurfaceInWidthsOfTheVertex) {
    // A strand of width 0.4 along y; probes of the same width 0.4 at distances from its axis: (D - 0.2) / 0.4. Beyond
    // its end, at y = 2: to the round end.
    StrandModel model;
    model.add(straight({0, -1, 0}, {0, 1, 0}, 3), 0.4);
    const auto first =
        model.add_probes({{0.4, 0, 0}, {0.1, 0.3, 0}, {0, 0.2, 0.2}, {0, 2, 0}, {0.3, 1.4, 0}, {3, 0, 0}});
    const StrandGeometry strands = model.geometry();
    std::vector<std::uint32_t> probes;
    for (std::uint32_t k = 0; k < 6; ++k) probes.push_back(first + k);
    const auto distance = distance_to_other_strands(strands, probes, 5);
    const double expected[] = {0.5, -0.25, 0, 2, 0.75, 5};  // the last lies (3 - 0.2) / 0.4 = 7 away: the limit
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(distance[k], expected[k], 1e-6) << k;
}

TEST(DistanceToOtherStrands, IgnoresTheVerticesOwnSegments) {
    // Own are the segments that begin within 8 widths along the strand (docs/math.md, "The traced reference"). The
    // next one on this straight strand begins at the first multiple of the segment's length beyond 8, and the surface
    // of its round end is half a width nearer.
    for (const auto [segment, expected] : {std::array{1.0, 8.5}, {0.3, 7.6}, {0.07, 7.55}, {30.0, 29.5}}) {
        StrandModel model;
        const int half = static_cast<int>(12 / segment) + 3;
        model.add(straight({0, 0, 0}, {2 * half * segment, 0, 0}, 2 * half), 1);
        const std::vector<std::uint32_t> middle{static_cast<std::uint32_t>(half)};
        EXPECT_NEAR(distance_to_other_strands(model.geometry(), middle, 50)[0], expected, 2e-4) << segment;
    }
}

TEST(DistanceToOtherStrands, TakesTheWidthAtTheFootPoint) {
    // A cone from width 0.2 to 0.6: 0.4 in the middle.
    HairModel model;
    model.strand_begin = {0, 2, 3};
    model.positions = {{0, 0, 0}, {0, 2, 0}, {1, 1, 0}};
    model.thickness = {0.2f, 0.6f, 0.1f};
    const StrandGeometry strands = make_strand_geometry(model, {});
    EXPECT_NEAR(distance_to_other_strands(strands, std::vector<std::uint32_t>{2}, 20)[0], (1 - 0.2) / 0.1, 1e-5);
}

TEST(DistanceToOtherStrands, AgreesWithLookingAtEverySegment) {
    Random random(9);
    StrandModel model;
    for (int s = 0; s < 200; ++s) {
        std::vector<Vec3d> points{random_point_in_ball(random, 1)};
        for (int k = 0; k < 6; ++k) points.push_back(points.back() + random_direction(random) * random.next(0.06, 0.5));
        model.add(points, random.next(0.01, 0.05));  // segments longer than the width: none is joined to a vertex
    }
    const StrandGeometry strands = model.geometry();
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t v = 0; v < strands.vertex_count(); v += 7) vertices.push_back(v);
    for (const float limit : {0.5f, 3.0f, 100.0f}) {
        const auto distance = distance_to_other_strands(strands, vertices, limit);
        for (std::size_t k = 0; k < vertices.size(); ++k) {
            const std::uint32_t v = vertices[k];
            const Vec3d p(strands.positions[v]);
            double nearest = double(limit) * double(strands.widths[v]);
            for (std::uint32_t i = 0; i < strands.vertex_count(); ++i) {
                if (strands.segments[i] != Segment::solid || own_segments(strands, v).contains(i)) continue;
                const Vec3d a(strands.positions[i]), b(strands.positions[i + 1]);
                double to_axis = 1e9;  // ternary search: the distance is convex along the segment
                double low = 0, high = 1;
                for (int step = 0; step < 60; ++step) {
                    const double s = low + (high - low) / 3, t = high - (high - low) / 3;
                    const double at_s = length(p - (a + (b - a) * s)), at_t = length(p - (a + (b - a) * t));
                    (at_s < at_t ? high : low) = at_s < at_t ? t : s;
                    to_axis = std::min({to_axis, at_s, at_t});
                }
                nearest = std::min(nearest, to_axis - 0.5 * double(strands.widths[i]));
            }
            EXPECT_NEAR(distance[k], nearest / double(strands.widths[v]), 1e-4) << "vertex " << v;
        }
    }
}

TEST(DistanceToOtherStrands, IsTheSameForAnyNumberOfThreadsAndAtAnyScale) {
    Random random(10);
    StrandModel model;
    for (int s = 0; s < 1000; ++s) {
        const Vec3d p = random_point_in_ball(random, 1);
        model.add(straight(p, p + random_direction(random) * 0.4, 8), 0.01);
    }
    const StrandGeometry strands = model.geometry();
    const auto vertices = all_vertices(strands);
    const auto expected = distance_to_other_strands(strands, vertices, 2);
    for (const int threads : {1, 2, 7})
        with_threads(threads, [&] { EXPECT_EQ(distance_to_other_strands(strands, vertices, 2), expected); });
    for (const double scale : {1e-15, 1e15}) {
        const StrandGeometry scaled = model.geometry([&](const Vec3d& p) { return p * scale; }, scale);
        const auto distance = distance_to_other_strands(scaled, vertices, 2);
        // Positions of about 1 are rounded by 6e-8, 6e-6 of a width.
        for (std::size_t k = 0; k < vertices.size(); ++k) EXPECT_NEAR(distance[k], expected[k], 5e-5) << scale;
    }
}

TEST(DistanceToOtherStrands, SurvivesModelsThatHoldNothing) {
    StrandModel model;
    model.add({{0, 0, 0}}, 1);
    model.add({{0, 0, 0}, {0, 0, 0}}, 1);
    const std::vector<std::uint32_t> vertices{0, 1, 2};
    EXPECT_EQ(distance_to_other_strands(model.geometry(), vertices, 1), std::vector<float>(3, 1));
    EXPECT_TRUE(distance_to_other_strands(model.geometry(), {}, 1).empty());
    EXPECT_TRUE(distance_to_other_strands(StrandModel().geometry(), {}, 1).empty());
}

}  // namespace
}  // namespace hairbake
