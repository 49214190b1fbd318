#include "core/volume/grid_frame.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/volume/transmittance.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

/// A diagonal strand through the box from (0, 0, 0) to (4, 2, 1).
StrandGeometry diagonal(double width) {
    StrandModel model;
    model.add(straight({0, 0, 0}, {4, 2, 1}, 19), width);
    return model.geometry();
}

TEST(GridFrame, DividesTheLongestSideIntoTheVoxelsAskedFor) {
    for (const int voxels : {32, 100, 256, 1024}) {
        const GridFrame frame = make_grid_frame(diagonal(1e-4), with_voxels(voxels));
        EXPECT_DOUBLE_EQ(frame.voxel_size, 4.0 / voxels);
        EXPECT_EQ(frame.reason, VoxelReason::asked);
    }
}

TEST(GridFrame, TakesAVoxelSizeInsteadOfACount) {
    TransmittanceSettings settings = with_voxel_size(0.0625);
    settings.voxels = 1024;
    EXPECT_EQ(make_grid_frame(diagonal(1e-4), settings).voxel_size, 0.0625);
}

TEST(GridFrame, KeepsVoxelsAtLeastTwiceAsLargeAsTheWidths) {
    const double twice = 2 * double(static_cast<float>(0.1));
    for (const TransmittanceSettings& settings : {with_voxels(256), with_voxel_size(0.01)}) {
        const GridFrame frame = make_grid_frame(diagonal(0.1), settings);
        EXPECT_DOUBLE_EQ(frame.voxel_size, twice);
        EXPECT_EQ(frame.reason, VoxelReason::width);
    }
    const GridFrame frame = make_grid_frame(diagonal(0.1), with_voxel_size(0.25));
    EXPECT_DOUBLE_EQ(frame.voxel_size, 0.25);
    EXPECT_EQ(frame.reason, VoxelReason::asked);
}

TEST(GridFrame, TakesThe95thPercentileOfTheWidths) {
    // 100 strands of two points; the 95th percentile of 200 widths is the one of rank floor(199 x 0.95) = 189 from 0.
    for (const int wide : {4, 6}) {  // 8 and 12 wide points: ranks from 192 and from 188
        StrandModel model;
        for (int s = 0; s < 100; ++s) model.add(straight({0, 0.01 * s, 0}, {4, 0, 0}), s < wide ? 0.5 : 0.001);
        const GridFrame frame = make_grid_frame(model.geometry(), with_voxels(256));
        EXPECT_EQ(frame.reason == VoxelReason::width, wide == 6);
        EXPECT_DOUBLE_EQ(frame.voxel_size, wide == 6 ? 1.0 : 4.0 / 256);
    }
}

TEST(GridFrame, WidthsThatRepeatWithTheStrandsAreNotMistakenForTheirRoots) {
    // 5,000 strands of 30 points, 0.5 wide at the root and 0.001 elsewhere: 1 width of 30 is above the 95th percentile.
    // Any step through the 150,000 that is a multiple of 30, or shares 2, 3 or 5 with it, meets roots too often.
    std::vector<float> widths;
    for (int i = 0; i < 150'000; ++i) widths.push_back(i % 30 == 0 ? 0.5f : 0.001f);
    EXPECT_EQ(typical_largest_width(widths), 0.001f);
    // Two of 30, 6.7 %, are more than 5 %, wherever in the strand they are.
    for (int i = 0; i < 150'000; ++i) widths[i] = i % 30 == 7 || i % 30 == 8 ? 0.5f : 0.001f;
    EXPECT_EQ(typical_largest_width(widths), 0.5f);
    // As long a model as makes a step of 30 out of a sample of 65,536: 29 * 65,536 points and more.
    widths.clear();
    for (int i = 0; i < 29 * 65536 + 30; ++i) widths.push_back(i % 30 == 0 ? 0.5f : 0.001f);
    EXPECT_EQ(typical_largest_width(widths), 0.001f);
}

TEST(GridFrame, WarnsOfTheWidthBoundWithTheVoxelSizeThatHolds) {
    Progress progress;
    const Transmittance wide = bake_transmittance_volume({diagonal(0.125)}, with_voxels(256), progress);
    EXPECT_EQ(wide.voxel_size, 0.25);
    ASSERT_EQ(wide.warnings.size(), 1u);
    EXPECT_NE(wide.warnings[0].find("0.25"), std::string::npos) << wide.warnings[0];
    EXPECT_TRUE(bake_transmittance_volume({diagonal(0.001)}, with_voxels(256), progress).warnings.empty());
}

TEST(GridFrame, RefusesMoreThan1024VoxelsAndNamesTheField) {
    EXPECT_NO_THROW(make_grid_frame(diagonal(1e-5), with_voxel_size(4.0 / 1024)));
    try {
        make_grid_frame(diagonal(1e-5), with_voxel_size(4.0 / 1026));
        ADD_FAILURE() << "was accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_EQ(error.field(), "transmittance.voxel_size");
        EXPECT_NE(std::string(error.what()).find("1024"), std::string::npos) << error.what();
    }
}

TEST(GridFrame, HoldsEveryVertexWithAVoxelOfMarginBelow) {
    // Also where the rounding of positions is coarser than a voxel: at 1e7 floats are one apart.
    for (const double offset : {0.0, 1.0, -7.3, 1e3, -1e5, 1e7})
        for (const int voxels : {32, 253, 256, 1024}) {
            Random random(1);
            StrandModel model;
            for (int k = 0; k < 200; ++k)
                model.add({random_point_in_box(random, Vec3d(-1), Vec3d(1)) + Vec3d(offset, -offset, offset)}, 1e-6);
            model.add_box(Vec3d(-1) + Vec3d(offset, -offset, offset), Vec3d(1) + Vec3d(offset, -offset, offset));
            const StrandGeometry strands = model.geometry();
            const GridFrame frame = make_grid_frame(strands, with_voxels(voxels));
            for (const Vec3f& p : strands.positions)
                for (int axis = 0; axis < 3; ++axis) {
                    const float g = frame.to_grid(p)[axis];
                    // A margin that a float at this offset can express.
                    EXPECT_GE(g, std::abs(offset) < 1e4 ? 0.9f : 0.0f);
                    EXPECT_LT(g, static_cast<float>(frame.voxels(axis)));
                }
        }
}

TEST(GridFrame, NumbersBricksAndVoxelsAsOpenVdbDoes) {
    GridFrame frame;
    frame.bricks = {3, 5, 7};
    std::uint32_t expected = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 5; ++j)
            for (int k = 0; k < 7; ++k, ++expected) {
                EXPECT_EQ(frame.brick_of(8 * i + 7, 8 * j, 8 * k + 3), expected);
                EXPECT_EQ(frame.brick_at(Vec3f(8 * i + 7.9f, 8.0f * j, 8 * k + 3.5f)), expected);
                EXPECT_EQ(frame.brick_coordinates(expected), (std::array{i, j, k}));
            }
    EXPECT_EQ(frame.brick_count(), expected);
    EXPECT_EQ(GridFrame::voxel_in_brick(8 + 3, 16 + 5, 7), 3 * 64 + 5 * 8 + 7);
}

}  // namespace
}  // namespace hairbake
