// Models that are empty, degenerate or out of range.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/volume/transmittance.h"
#include "tests/core/volume/tuft.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

TEST(Transmittance, OfAnEmptyModelIsEmpty) {
    Progress progress;
    const Transmittance baked = bake_transmittance_volume({StrandModel().geometry()}, {}, progress);
    EXPECT_TRUE(baked.average.empty());
    EXPECT_EQ(baked.directions, 100);
    EXPECT_EQ(baked.density, nullptr);
}

TEST(Transmittance, IsOneWhereNothingIsWhateverTheCoordinates) {
    // One point, many points in one place, two points: at 0, at 1e15 and at 1e-15.
    for (const Vec3d& place : {Vec3d(0), Vec3d(1e15, -1e15, 3e14), Vec3d(1e-15, 2e-15, 0), Vec3d(1e7, 1e7, -1e7)})
        for (const int count : {1, 2, 50})
            for (const double width : {1e-15, 1.0, 1e15}) {
                StrandModel model;
                model.add(std::vector<Vec3d>(static_cast<std::size_t>(count), place), width);
                model.add({place}, width);
                for (const float a : bake(model.geometry())) EXPECT_NEAR(a, 1, 1e-6) << place.x << " " << width;
            }
}

TEST(Transmittance, IsAShareForHostileModels) {
    // Enormous widths, a model of no thickness on two axes, extents that floats at that place cannot resolve,
    // strands as long as the model is large.
    const auto expect_shares = [](const StrandGeometry& strands, const TransmittanceSettings& settings) {
        for (const float a : bake(strands, settings)) {
            ASSERT_GE(a, 0);
            ASSERT_LE(a, 1);
        }
    };
    const StrandModel model = tuft();
    const auto same = [](const Vec3d& p) { return p; };
    for (const double width_scale : {1e-30, 1e-6, 10.0, 1e3, 1e12})
        expect_shares(model.geometry(same, width_scale), with_voxels(40));
    expect_shares(model.geometry([](const Vec3d& p) { return Vec3d(p.x, 0, 0); }), with_voxels(256));
    expect_shares(model.geometry([](const Vec3d& p) { return p + Vec3d(1e7, 0, -1e7); }), with_voxels(1024, 9));
    expect_shares(model.geometry([](const Vec3d& p) { return Vec3d(p.x * 1e10, p.y, p.z * 1e-10); }),
                  with_voxels(1024, 9));
    expect_shares(model.geometry([](const Vec3d& p) { return p * 1e15; }), with_voxels(32));
    expect_shares(model.geometry([](const Vec3d& p) { return p * 1e-15; }, 1e-15), with_voxels(32));
}

TEST(Transmittance, OfAThousandStrandsInOnePlaceIsAShare) {
    // All in one voxel: the extinction leaves the range of half floats.
    StrandModel model;
    for (int s = 0; s < 1000; ++s) model.add(straight({-0.001, 0, 0}, {0.001, 0, 0}, 2), 0.02);
    for (int s = 0; s < 100; ++s) model.add(straight({-1, -1, -1}, {1, 1, 1}, 1), 0.02);
    for (const float a : bake(model.geometry(), with_voxels(32))) {
        ASSERT_GE(a, 0);
        ASSERT_LE(a, 1);
    }
}

TEST(Transmittance, RefusesBoundsThatNoGridHolds) {
    StrandModel model;
    model.add({{-1e36, 0, 0}, {1e36, 0, 0}}, 1);
    try {
        bake(model.geometry());
        ADD_FAILURE() << "was accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
    }
}

TEST(Transmittance, AVoxelThatHoldsTheWholeModelIsBakedWithBoundedWork) {
    // 100,000 strands of length 0.1 in one voxel of edge 1: corrected pair by pair, they would take minutes (and the
    // test's time-out). A width of 5e-5 gives the voxel a trace of 1e5 * 0.1 * 5e-5 = 0.5. The optical depth of a way
    // of length s is at most trace * s, and no way inside the voxel is longer than sqrt(3): A >= exp(-0.87) = 0.42. The
    // near field is left alone beyond 4,096 pieces, so nothing but the own strand (factor exp(0.35 * 5e-5)) is above 1.
    Random random(5);
    StrandModel model;
    model.add_box({0, 0, 0}, {32, 32, 32});
    for (int i = 0; i < 100'000; ++i) {
        const Vec3d a = random_point_in_box(random, {16.4, 16.4, 16.4}, {16.6, 16.6, 16.6});
        model.add({a, a + random_direction(random) * 0.1}, 5e-5);
    }
    const auto average = bake(model.geometry(), with_voxel_size(1));
    ASSERT_EQ(average.size(), 200'002u);
    const auto [least, most] = std::minmax_element(average.begin() + 2, average.end());
    EXPECT_GE(*least, 0.42f);
    EXPECT_LT(*most, 0.99f);
}

}  // namespace
}  // namespace hairbake
