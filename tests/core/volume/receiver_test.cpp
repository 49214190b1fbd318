// The hemisphere means of the sweep at the points of a receiving surface.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/base/parallel.h"
#include "core/visibility/direction_set.h"
#include "core/visibility/hemisphere_means.h"
#include "tests/core/volume/volume_steps.h"
#include "tests/support/random_media.h"
#include "tests/support/receiver_points.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

std::vector<float> receive(const StrandGeometry& strands, const TriangleMesh& receiver,
                           const TransmittanceSettings& settings, const TriangleMesh* occluder = nullptr,
                           bool is_occluder = false) {
    Progress progress;
    TransmittanceScene scene{strands, occluder};
    scene.receiver = &receiver;
    scene.receiver_is_occluder = is_occluder;
    return bake_transmittance_volume(scene, settings, progress).receiver;
}

/// Straight strands in a box of 1 x 0.8 x 0.6 about the origin. The box is a multiple of 1/32 on every side.
StrandModel block(int strands = 2000) {
    Random random(17);
    StrandModel model;
    model.add_box(Vec3d(-0.5, -0.375, -0.25), Vec3d(0.5, 0.375, 0.25));
    for (int s = 0; s < strands; ++s) {
        const Vec3d p = random_point_in_box(random, {-0.4, -0.3, -0.2}, {0.4, 0.3, 0.2});
        model.add(straight(p, p + random_direction(random) * 0.04), 0.01, random.next(0.2, 1));
    }
    return model;
}

/// Points inside, beside, above and below that block, near and far.
std::vector<std::pair<Vec3d, Vec3d>> around() {
    Random random(18);
    std::vector<std::pair<Vec3d, Vec3d>> points;
    for (const double reach : {0.4, 1.0, 1.9})
        for (int k = 0; k < 60; ++k)
            points.emplace_back(random_point_in_box(random, Vec3d(-reach), Vec3d(reach)), random_direction(random));
    return points;
}

TEST(Receiver, IsExactlyOneWhereNothingIsInTheWay) {
    StrandModel model;
    model.add_probes({{0, 0, 0}, {1, 1, 1}});
    const StrandGeometry strands = model.geometry();
    const TriangleMesh points = receiver_points(around());
    for (const DirectionSet set : {DirectionSet::fibonacci, DirectionSet::stratified, DirectionSet::random}) {
        TransmittanceSettings settings = with_voxels(32);
        settings.direction_set = set;
        EXPECT_EQ(receive(strands, points, settings), std::vector<float>(2 * points.positions.size(), 1));
    }
    // Beside the hair, looking away from it, and far away.
    const TriangleMesh away =
        receiver_points({{{2, 0, 0}, {1, 0, 0}}, {{0, -1e6, 0}, {0, -1, 0}}, {{1e30, 0, 0}, {1, 0, 0}}});
    EXPECT_EQ(receive(block().geometry(), away, with_voxels(32)), std::vector<float>(6, 1));
}

TEST(Receiver, IsTheMeanOfTheSweepOfEveryDirection) {
    // Lone vertices at the points' places give T_k, one direction at a time. The fixed point rounds by 2^-25 of
    // the range for four directions: 1e-5 of the means.
    StrandModel model = block();
    Random random(19);
    std::vector<Vec3d> places;
    std::vector<std::pair<Vec3d, Vec3d>> points;
    for (int k = 0; k < 100; ++k) {
        places.push_back(random_point_in_box(random, {-0.45, -0.33, -0.22}, {0.45, 0.33, 0.22}));
        points.emplace_back(places.back(), random_direction(random));
    }
    const auto first = model.add_probes(places);
    const StrandGeometry strands = model.geometry();
    const TriangleMesh receiver = receiver_points(points);
    const HairVolume volume = volume_of(strands, with_voxel_size(1 / 32.0));
    const auto directions = make_directions(DirectionSet::fibonacci, 50, 0);
    std::vector<HemisphereSums> sums(places.size());
    for (const Vec3d& w : directions) {
        const auto t = sweep_one(volume, w);
        for (std::size_t i = 0; i < sums.size(); ++i)
            sums[i].add(double{t[first + i]}, dot(Vec3d(receiver.normals[i]), w));
    }
    const auto seen = receive(strands, receiver, with_voxel_size(1 / 32.0, 50));
    for (std::size_t i = 0; i < sums.size(); ++i)
        for (std::size_t c = 0; c < 2; ++c) ASSERT_NEAR(seen[2 * i + c], sums[i].means()[c], 1e-5);
}

TEST(Receiver, OutsideTheGridSeesWhatALargerGridWouldShow) {
    // In a grid of four times the side all points lie inside. Its voxels are the same (the bounds move by whole
    // voxels). Its lattice of rays is shifted by up to half a voxel, which is noise without bias. A point that read the
    // wrong rays would be wrong by tenths.
    StrandModel model = block();
    const StrandGeometry small = model.geometry();
    model.add_box(Vec3d(-2), Vec3d(2));
    const StrandGeometry large = model.geometry();
    const TriangleMesh receiver = receiver_points(around());
    const auto outside = receive(small, receiver, with_voxel_size(1 / 32.0)),
               inside = receive(large, receiver, with_voxel_size(1 / 32.0));
    int shadowed = 0;
    double sum = 0, square = 0;
    for (std::size_t i = 0; i < outside.size(); ++i) {
        const double difference = double(outside[i]) - double(inside[i]);
        EXPECT_NEAR(difference, 0, 0.06) << i;
        sum += difference;
        square += difference * difference;
        shadowed += inside[i] < 0.9f ? 1 : 0;
    }
    EXPECT_GT(shadowed, 60) << "the test is too weak";
    EXPECT_NEAR(sum / double(outside.size()), 0, 0.003);
    EXPECT_LT(std::sqrt(square / double(outside.size())), 0.015);
}

/// The means of a point under a box of isotropic fibres of this extinction, from 4,096 rays through the box.
std::array<float, 2> under_box(double extinction, const Vec3d& p) {
    HemisphereSums sums;
    for (const Vec3d& w : make_directions(DirectionSet::fibonacci, 4096, 0)) {
        const Interval inside = box(Vec3d(-5, -5, 0), Vec3d(5, 5, 1))(p, w);
        sums.add(std::exp(-extinction * std::max(0.0, inside.end - std::max(0.0, inside.begin))), w.z);
    }
    return sums.means();
}

TEST(Receiver, UnderASlabOfIsotropicFibresSeesTheExponentialOfTheWays) {
    // A voxel below a slab of height 1, 10 wide. For an infinite slab the means are the exponential integrals E2 and
    // 2 E3: 0.327 and 0.443 at depth 0.5, and the box's are within 0.05 of that. Two realisations scatter by less than
    // 0.01; the slab's edge, by a quarter of a voxel, by 0.01.
    for (const double tau : {0.5, 1.5}) {
        double plain = 0, cosine = 0;
        for (int seed = 1; seed <= 2; ++seed) {
            Random random(static_cast<std::uint64_t>(seed));
            const Medium slab = slab_medium(random, {.width = 0.004, .length = 0.3, .extinction = tau}, 1, 10, 0.5, 1,
                                            Truth::mean_field);
            std::vector<std::pair<Vec3d, Vec3d>> points;
            for (int k = 0; k < 100; ++k)
                points.push_back({{random.next(-1, 1), random.next(-1, 1), -0.05}, {0, 0, 1}});
            const TriangleMesh receiver = receiver_points(points);
            const auto seen = receive(slab.model.geometry(), receiver, with_voxel_size(0.05));
            for (std::size_t i = 0; i < 100; ++i) {
                const auto expected = under_box(tau, Vec3d(receiver.positions[i]));
                plain += (double{seen[2 * i]} - double{expected[0]}) / 200;
                cosine += (double{seen[2 * i + 1]} - double{expected[1]}) / 200;
            }
        }
        EXPECT_NEAR(plain, 0, 0.02) << tau;
        EXPECT_NEAR(cosine, 0, 0.02) << tau;
    }
    EXPECT_NEAR(under_box(0.5, Vec3d(0, 0, -0.05))[1], 0.443, 0.05);
}

TEST(Receiver, DoesNotChangeTheVerticesAndGivesTheSameBitsForAnyNumberOfThreads) {
    const StrandGeometry strands = block().geometry();
    const TriangleMesh receiver = receiver_points(around());
    Progress progress;
    TransmittanceScene scene{strands};
    scene.receiver = &receiver;
    Transmittance one;
    with_threads(1, [&] { one = bake_transmittance_volume(scene, with_voxels(40), progress); });
    EXPECT_EQ(one.average, bake(strands, with_voxels(40)));
    for (const int threads : {2, 7})
        with_threads(threads, [&] { EXPECT_EQ(receive(strands, receiver, with_voxels(40)), one.receiver); });
}

TEST(Receiver, IsShadowedByTheOccluderUnlessItIsTheOccluder) {
    // As in directional_trace_test.cpp: a roof over one point, under the other. The hair is far to the side.
    StrandModel model;
    model.add({{5, 5, 5}, {5, 5, 5.1}}, 0.001);
    model.add_box(Vec3d(-5), Vec3d(5));
    const TriangleMesh roof = square(1, 1000),
                       points = receiver_points({{{0, 0, -1}, {0, 0, 1}}, {{0, 0, 3}, {0, 0, 1}}});
    const auto shadowed = receive(model.geometry(), points, with_voxels(32, 400), &roof);
    EXPECT_LT(shadowed[0], 0.005);
    EXPECT_LT(shadowed[1], 1e-4);
    EXPECT_GT(shadowed[2], 0.999);
    EXPECT_GT(receive(model.geometry(), points, with_voxels(32, 400), &roof, true)[0], 0.999);
}

TEST(Receiver, WithoutHairIsShadowedByTheOccluderAlone) {
    // The roof reaches 30 to each side, 2 above the point: past its edge the cosine is below 2 / 30.
    const StrandGeometry none = StrandModel().geometry();
    const TriangleMesh roof = square(1, 30),
                       points = receiver_points({{{0, 0, -1}, {0, 0, 1}}, {{0, 0, 3}, {0, 0, 1}}});
    EXPECT_EQ(receive(none, points, {}), std::vector<float>(4, 1));
    const auto seen = receive(none, points, {}, &roof);
    EXPECT_LT(seen[0], 0.09);
    EXPECT_LT(seen[1], 0.01);
    EXPECT_EQ(seen[2], 1);
    EXPECT_EQ(receive(none, points, {}, &roof, true), std::vector<float>(4, 1));
}

TEST(Receiver, WithoutADirectionAboveItsPlaneIsToldInAWarning) {
    // The one direction of a set of one is (1, 0, 0).
    const StrandGeometry strands = block().geometry();
    const TriangleMesh receiver = receiver_points({{{-2, 0, 0}, {-1, 0, 0}}, {{-2, 0, 0}, {1, 0, 0}}});
    Progress progress;
    TransmittanceScene scene{strands};
    scene.receiver = &receiver;
    const Transmittance baked = bake_transmittance_volume(scene, with_voxels(32, 1), progress);
    EXPECT_EQ(baked.receiver[0], 1);
    EXPECT_EQ(baked.receiver[1], 1);
    EXPECT_LT(baked.receiver[2], 0.9);
    ASSERT_FALSE(baked.warnings.empty());
    EXPECT_EQ(baked.warnings.back().substr(0, 2), "1 ");
}

}  // namespace
}  // namespace hairbake
