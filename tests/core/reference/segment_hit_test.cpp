// Hits of rays on segments against an independent intersector, through Embree and without it.
#include "core/reference/segment_hit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/visibility/direction_set.h"
#include "tests/core/reference/trace.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

/// Squared distance of the ray from `o` along `d` to the segment a, b by golden-section search over the segment: no
/// formula is shared with the code under test. In long double.
struct Long3 {
    long double x, y, z;
};
Long3 minus(const Long3& a, const Long3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
long double dot_of(const Long3& a, const Long3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Long3 widened(const Vec3f& v) { return {v.x, v.y, v.z}; }

long double distance_at(const Long3& o, const Long3& d, const Long3& a, const Long3& b, long double s) {
    const Long3 p = minus({a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), a.z + s * (b.z - a.z)}, o);
    const long double t = std::max(0.0L, dot_of(p, d) / dot_of(d, d));
    const Long3 off{p.x - t * d.x, p.y - t * d.y, p.z - t * d.z};
    return std::sqrt(dot_of(off, off));
}

long double distance_to_segment(const Long3& o, const Long3& d, const Long3& a, const Long3& b) {
    long double low = 0, high = 1;
    const long double golden = (std::sqrt(5.0L) - 1) / 2;
    for (int step = 0; step < 160; ++step) {
        const long double first = high - golden * (high - low), second = low + golden * (high - low);
        (distance_at(o, d, a, b, first) < distance_at(o, d, a, b, second) ? high : low) =
            distance_at(o, d, a, b, first) < distance_at(o, d, a, b, second) ? second : first;
    }
    return distance_at(o, d, a, b, (low + high) / 2);
}

/// A segment through a random point, and rays from a probe that pass it at 0 to 2 radii.
struct Shot {
    StrandModel model;
    std::uint32_t probe;
    std::vector<Vec3d> directions;
};

/// width: of a segment of length 1; distance: of the probe from the point aimed at
Shot make_shot(double width, double distance, std::uint64_t seed) {
    Random random(seed);
    Shot shot;
    const Vec3d axis = random_direction(random), middle = random_point_in_ball(random, 1);
    const std::uint32_t first = shot.model.add({middle - axis * 0.5, middle + axis * 0.5}, width);
    (void)first;
    const Vec3d target = middle + axis * (random.next() - 0.5), from = target + random_direction(random) * distance;
    shot.probe = shot.model.add_probes({from});
    for (int i = 0; i < 64; ++i) {
        const Vec3d aim = target + random_direction(random) * (width * random.next());
        shot.directions.push_back(normalized(aim - Vec3d(Vec3f(from))));
    }
    return shot;
}

TEST(SegmentHit, AgreesWithAnIndependentIntersectorOverEightOrdersOfLengthToWidthAndOfDistance) {
    int compared = 0, met = 0;
    for (int exponent = 0; exponent <= 8; ++exponent)
        for (int far = 0; far <= 8; ++far)
            for (std::uint64_t seed = 1; seed <= 8; ++seed) {
                const double width = std::pow(10.0, -exponent), distance = width * std::pow(10.0, far);
                if (distance > 100) continue;  // a model whose segments are specks is refused as having a stray point
                const Shot shot = make_shot(width, distance, seed + 100 * exponent + 1000 * far);
                const StrandGeometry strands = shot.model.geometry();
                const Long3 origin = widened(strands.positions[shot.probe]);
                const Long3 a = widened(strands.positions[0]), b = widened(strands.positions[1]);
                std::vector<float> traced(shot.directions.size());
                for (std::size_t k = 0; k < shot.directions.size(); ++k)
                    traced[k] = trace(strands, {shot.probe}, {shot.directions[k]})[0];
                for (std::size_t k = 0; k < shot.directions.size(); ++k) {
                    const Vec3f l(shot.directions[k]);  // the tracer's own rounding of directions
                    const long double radius = 0.5L * strands.widths[0];
                    const long double d = distance_to_segment(origin, widened(l), a, b);
                    // Undecided is what doubles cannot tell at these sizes, and the unit length of l to float's digits.
                    const long double size = std::max<long double>(1, distance);
                    if (std::abs(d - radius) < 1e-13L * size + 1e-6L * radius) continue;
                    const bool expected = d < radius;
                    ++compared;
                    met += expected;
                    ASSERT_EQ(ray_meets_segment(strands, 0, Vec3d(strands.positions[shot.probe]), Vec3d(l)), expected)
                        << "width " << width << " distance " << distance << " off by " << double(d / radius);
                    ASSERT_EQ(traced[k] == 0, expected)
                        << "Embree: width " << width << " distance " << distance << " off by " << double(d / radius);
                }
            }
    EXPECT_GT(compared, 20000);
    EXPECT_GT(met, compared / 8);
    EXPECT_LT(met, compared * 7 / 8);
}

TEST(SegmentHit, ATaperedSegmentIsTheHullOfItsTwoSpheres) {
    // Against the definition: the union of spheres about all points of the axis, with radii that run linearly.
    Random random(5);
    int met = 0;
    for (int i = 0; i < 4000; ++i) {
        StrandModel model;
        model.add({random_point_in_ball(random, 1), random_point_in_ball(random, 1)}, 1);
        const auto probe = model.add_probes({random_point_in_ball(random, 2)});
        StrandGeometry strands = model.geometry();
        strands.widths[0] = static_cast<float>(random.next());
        strands.widths[1] = static_cast<float>(0.2 * random.next());
        const Vec3d l = random_direction(random), origin(strands.positions[probe]);
        const Long3 o = widened(strands.positions[probe]), d{l.x, l.y, l.z};
        const Long3 a = widened(strands.positions[0]), b = widened(strands.positions[1]);
        long double least = 1e9L;  // distance less radius, on 20,001 spheres: off by at most 1e-4 of the axis's length
        for (int k = 0; k <= 20000; ++k) {
            const long double s = k / 20000.0L;
            least = std::min(least, distance_at(o, d, a, b, s) -
                                        0.5L * (strands.widths[0] + s * (strands.widths[1] - strands.widths[0])));
        }
        if (std::abs(least) < 2e-4L) continue;
        met += least < 0;
        ASSERT_EQ(ray_meets_segment(strands, 0, origin, l), least < 0) << i << ": " << double(least);
    }
    EXPECT_GT(met, 60);
}

TEST(SegmentHit, LongThinStrandsInABallLetThroughWhatTheMeanFieldSays) {
    // 20,000 parallel strands of random places in a unit ball. Strands that cross the ball at the distance u from its
    // middle are 2 sqrt(1 - u^2) long; with N of them over the disc of the ball (area pi) and width w, the optical
    // depth from the centre across them over the way s is N w s / pi (each square of the disc has N / pi strands), so
    // at the angle a to the axis sin(a) N w / pi for all s = 1. The mean of exp(-k sin a) over the sphere, k = N w /
    // pi, is found by Simpson's rule. w is 1.6e-4: a segment is 8,000 times longer than wide.
    Random random(3);
    StrandModel model;
    constexpr int count = 20000;
    constexpr double width = 1.6e-4;
    for (int i = 0; i < count; ++i) {
        const double r = std::sqrt(random.next()), phi = 2 * std::numbers::pi * random.next();
        const double half = std::sqrt(1 - r * r);
        if (half < 0.01) continue;
        const double x = r * std::cos(phi), y = r * std::sin(phi);
        model.add({{x, y, -half}, {x, y, half}}, width);
    }
    const auto probe = model.add_probes({{0, 0, 0}});
    const double k = count * width / std::numbers::pi;
    double expected = 0;
    constexpr int steps = 1000;
    for (int i = 0; i <= steps; ++i) {
        const double a = std::numbers::pi * i / steps, weight = i == 0 || i == steps ? 1 : i % 2 ? 4 : 2;
        expected += weight * std::exp(-k * std::sin(a)) * std::sin(a) / 2 * (std::numbers::pi / steps / 3);
    }
    const float traced = trace(model.geometry(), {probe}, many_directions(4))[0];
    // One place of the strands among many: in each of some 300 independent gaps between them around the centre (k + 1
    // strands a radius) the share of free directions varies; measured over seeds it has a standard deviation of 0.03.
    EXPECT_NEAR(traced, expected, 0.09);
}

}  // namespace
}  // namespace hairbake
