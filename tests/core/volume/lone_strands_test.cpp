// Strands alone or in pairs, where the truth is known and the mean field is at its weakest.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/visibility/direction_set.h"
#include "tests/core/volume/volume_steps.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

constexpr double h = 1.0 / 32;

/// A straight strand of `segments` in a random direction at a random place of a grid of about 77 voxels of size h.
StrandGeometry lone_strand(Random& random, double width, int segments) {
    const Vec3d d = random_direction(random), p = random_point_in_ball(random, 0.1);
    StrandModel model;
    model.add(straight(p - d, p + d, segments), width);
    model.add_box(Vec3d(-1.2), Vec3d(1.2));
    return model.geometry();
}

/// What a lone straight strand may lack of the true A, which is 1, divided by w/h. What is left after the correction
/// scatters with the strand's place in its voxels by about 0.02 w/h; the worst of thousands of vertices lacks 0.16 w/h.
/// It is one-sided because A is at most 1.
constexpr double lone_strand_error = 0.2;

TEST(Transmittance, OfALoneStraightStrandIsOne) {
    Random random(1);
    for (const double ratio : {0.02, 0.1, 0.25, 0.5})
        for (int k = 0; k < 40; ++k) {
            const StrandGeometry strands = lone_strand(random, ratio * h, 1 + 4 * (k % 10));
            for (const float a : bake(strands, with_voxel_size(h))) {
                EXPECT_GE(a, 1 - lone_strand_error * ratio) << "w/h = " << ratio;
                EXPECT_LE(a, 1);
            }
        }
}

TEST(Transmittance, OfALoneStraightStrandIsOneAtAllVoxelsAndAnyNumberOfPoints) {
    // The longest side is that of the box, 2.4. The points are from 2 a strand to 40 a voxel.
    Random random(2);
    for (const int voxels : {32, 100, 256, 1024})
        for (const double ratio : {0.1, 0.5}) {
            const double width = 0.999 * ratio * 2.4 / voxels;  // wider than half a voxel would make the voxels larger
            for (const int segments : {1, 30, 3000})
                for (const float a : bake(lone_strand(random, width, segments), with_voxels(voxels)))
                    ASSERT_GE(a, 1 - lone_strand_error * ratio)
                        << voxels << " voxels, w/h = " << ratio << ", " << segments << " segments";
        }
}

TEST(Transmittance, OfAVertexIsNotDarkenedByClosePointsOfItsOwnStrand) {
    StrandModel model;
    std::vector<Vec3d> points;
    for (int k = 0; k < 5; ++k) points.push_back(Vec3d(1e-5 * k, 0.3, 0.2));
    model.add(points, 1e-4);
    model.add_box(Vec3d(-1), Vec3d(1));
    for (const float a : bake(model.geometry(), with_voxels(64))) EXPECT_GE(a, 0.99);
}

/// -ln A over w/h of a lone strand after the correction: mean and standard deviation over random strands, at the vertex
/// in the middle and at an end. The means go in halved, so that nothing is cut off at 1.
struct OwnDepth {
    double middle = 0, end = 0, middle_deviation = 0, end_deviation = 0;
};
OwnDepth own_depth(double ratio, int strand_count) {
    Random random(4);
    const auto directions = make_directions(DirectionSet::fibonacci, 256, 0);
    double sum[2]{}, sum2[2]{};
    for (int k = 0; k < strand_count; ++k) {
        const StrandGeometry strands = lone_strand(random, ratio * h, 2);
        const HairVolume volume = volume_of(strands, with_voxel_size(h));
        std::vector<std::vector<AngularMean>> means{sweep_means(volume, directions)};
        for (AngularMean& mean : means[0]) mean = {mean.average / 2, mean.slope / 2};
        Progress progress;
        const auto a = correct_near_field(strands, volume, means, progress)[0];
        for (const std::uint32_t v : {1u, 0u}) {
            const std::size_t c = v == 1 ? 0 : 1;
            const double depth = -std::log(2 * double(a[v])) / ratio;
            sum[c] += depth / strand_count;
            sum2[c] += depth * depth / strand_count;
        }
    }
    const auto deviation = [&](int c) { return std::sqrt(sum2[c] - sum[c] * sum[c]); };
    return {sum[0], sum[1], deviation(0), deviation(1)};
}

TEST(OwnShadow, IsWhatALoneStrandTakesInTheSweep) {
    // The strand takes about 0.6 w/h in the sweep and truly nothing. What is left is 0.02 w/h in the mean (the table
    // has a mean sine for each voxel, not the sine of each direction) and scatters by up to 0.04 w/h with the strand's
    // place.
    for (const double ratio : {0.01, 0.25, 0.5}) {
        const OwnDepth own = own_depth(ratio, 100);
        EXPECT_NEAR(own.middle, 0, 0.02) << ratio;
        EXPECT_NEAR(own.end, 0, 0.02) << ratio;
        EXPECT_LT(own.middle_deviation, 0.04) << ratio;
        EXPECT_LT(own.end_deviation, 0.04) << ratio;
    }
}

TEST(NearField, CorrectsEachOfSeveralMeansAsItWouldAlone) {
    // Means of three lights, and one that is dark everywhere: the correction leaves it alone.
    Random random(7);
    StrandModel model;
    fill(model, ball(1), Vec3d(-1), Vec3d(1), {.width = 0.02, .length = 0.3, .extinction = 1.5}, random);
    const StrandGeometry strands = model.geometry();
    const HairVolume volume = volume_of(strands, with_voxels(32));
    std::vector<std::vector<AngularMean>> means(4);
    for (const int directions : {7, 20, 50})
        means[directions == 7    ? 0
              : directions == 20 ? 1
                                 : 3] = sweep_means(volume, make_directions(DirectionSet::fibonacci, directions, 0));
    means[2].assign(strands.vertex_count(), {0.01f, {}});
    Progress progress;
    const auto together = correct_near_field(strands, volume, means, progress);
    ASSERT_EQ(together.size(), 4u);
    for (std::size_t m = 0; m < 4; ++m)
        EXPECT_EQ(together[m], correct_near_field(strands, volume, std::span(&means[m], 1), progress)[0]) << m;
    EXPECT_TRUE(correct_near_field(strands, volume, {}, progress).empty());
}

TEST(Transmittance, OfStrandsOfOnePointIsOne) {
    // No segments, no extinction: exp(0) in each direction, whichever width and opacity the point has.
    StrandModel model;
    for (int k = 0; k < 20; ++k) model.add({{0.1 * k, 0.05 * k * k, -0.3 * k}}, 0.01);
    model.add({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, 0.01);
    for (const float a : bake(model.geometry())) EXPECT_NEAR(a, 1, 1e-6);
}

TEST(Transmittance, OfAPointDoesNotDependOnItsOwnOpacity) {
    // A strand of one point carries no extinction, so there is nothing of its own to take out of the grid.
    const auto look = [](double opacity) {
        Random random(3);
        StrandModel model;
        fill(model, ball(1), Vec3d(-1), Vec3d(1), {.width = 0.02, .length = 0.3, .extinction = 1}, random);
        const auto probe = model.add({{0.1, 0.2, 0.3}}, 0.02, opacity);
        return bake(model.geometry(), with_voxels(32))[probe];
    };
    EXPECT_EQ(look(1), look(0));
}

TEST(Transmittance, IsNotChangedByDegenerateSegments) {
    // Repeated points bring no piece; the vertices there see what the first one sees.
    Random random(8);
    StrandModel plain, repeated;
    for (int s = 0; s < 300; ++s) {
        const Vec3d p = random_point_in_ball(random, 1), q = p + random_direction(random) * 0.3;
        plain.add({p, (p + q) / 2.0, q}, 0.01);
        repeated.add({p, (p + q) / 2.0, (p + q) / 2.0, q}, 0.01);
    }
    const StrandGeometry with = repeated.geometry();
    ASSERT_EQ(with.degenerate_segment_count, 300u);
    const auto a = bake(plain.geometry(), with_voxels(32)), b = bake(with, with_voxels(32));
    for (std::size_t s = 0; s < 300; ++s) {
        EXPECT_EQ(b[4 * s], a[3 * s]);
        EXPECT_EQ(b[4 * s + 1], a[3 * s + 1]);
        EXPECT_EQ(b[4 * s + 2], a[3 * s + 1]);
        EXPECT_EQ(b[4 * s + 3], a[3 * s + 2]);
    }
}

TEST(Transmittance, BesideAThinStrandIsRightInTheMeanOverPlaces) {
    // 1 - A = asin(r/d)/pi * b/sqrt(b^2 + d^2), b the strand's half length, looked at from a point (a vertex of a
    // second strand sees the same, but is cut off at 1 with its own strand's scatter). The grid knows the strand's
    // place to half a voxel: one place is off by up to its share of the sky at half a voxel's distance, w/h / (2 pi
    // (d/h - 0.5)), and a grid's grain; the mean over 100 places and directions agrees within four standard errors and
    // 3 % for the extinction's disjoint share.
    constexpr double ratio = 0.05;
    for (const double distance : {0.75, 1.0, 1.5, 3.0}) {
        Random random(2);
        const double d = distance * h;
        const double hidden = std::asin(ratio * h / 2 / d) / std::numbers::pi / std::sqrt(1 + d * d);
        double sum = 0, sum2 = 0;
        constexpr int places = 100;
        for (int k = 0; k < places; ++k) {
            const Vec3d along = random_direction(random), p = random_point_in_ball(random, 0.1);
            const Vec3d away = normalized(cross(along, random_direction(random)));
            StrandModel model;
            model.add(straight(p - along, p + along, 40), ratio * h);
            const auto probe = model.add_probes({p + away * d});
            model.add_box(Vec3d(-1.2), Vec3d(1.2));
            const double a = bake(model.geometry(), with_voxel_size(h, 256))[probe], error = a - (1 - hidden);
            EXPECT_NEAR(error, 0, 0.03) << distance;
            sum += error / places;
            sum2 += error * error / places;
        }
        const double standard_error = std::sqrt((sum2 - sum * sum) / places);
        EXPECT_LT(standard_error, 0.1 * hidden);
        EXPECT_NEAR(sum, 0, 4 * standard_error + 0.03 * hidden) << distance;
    }
}

TEST(Transmittance, OfTwoCrossingThinStrandsErrsByTwoHundredthsAtMost) {
    // The truth is 1 - asin(r/d)/pi * b/sqrt(b^2 + d^2); 0.02 is what one strand may be off by its own place, and the
    // other adds its own grain (above): 0.03 - that of the other is a tenth where d is 4 voxels.
    Random random(6);
    for (int k = 0; k < 40; ++k) {
        const Vec3d t = random_direction(random), p = random_point_in_ball(random, 0.1);
        const Vec3d away = normalized(cross(t, random_direction(random))), other = cross(t, away);
        const double d = 4 * h, w = 0.05 * h;
        StrandModel model;
        model.add(straight(p - other, p + other, 40), w);
        const auto first = model.add(straight(p + away * d - t, p + away * d + t, 20), w);
        const double hidden = std::asin(w / 2 / d) / std::numbers::pi / std::sqrt(1 + d * d);
        EXPECT_NEAR(bake(model.geometry(), with_voxel_size(h))[first + 10], 1 - hidden, 0.02);
    }
}

}  // namespace
}  // namespace hairbake
