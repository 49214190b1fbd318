#include "core/volume/strand_spacing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/parallel.h"
#include "core/volume/grid_frame.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace test_support;

/// n x n parallel strands of the length 1 in a unit square lattice of the spacing 1 / n, in the middles of its cells.
StrandGeometry square_lattice(int n, int segments = 8) {
    StrandModel model;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double x = (i + 0.5) / n, y = (j + 0.5) / n;
            model.add(straight({x, y, 0}, {x, y, 1}, segments), 1e-4);
        }
    return model.geometry();
}

double spacing(const StrandGeometry& strands) { return strand_spacing(strands, Progress()); }

TEST(StrandSpacing, OfStrandsInASquareLatticeIsTheLatticesSpacing) {
    // Strands closer together than a cell (1/32) fill all cells: V is that of the bounds, whose sides are 1 - 1/n, 1 -
    // 1/n and 1, and less than one cell more on each of two sides.
    for (const int n : {40, 64, 100}) {
        const double side = 1 - 1.0 / n, found = spacing(square_lattice(n));
        EXPECT_GT(found, side / n * 0.999) << n;
        EXPECT_LT(found, (side + 1.0 / 32) / n) << n;
    }
}

TEST(StrandSpacing, FollowsTheScaleAndNotHowStrandsAreCut) {
    const double one = spacing(square_lattice(40));
    EXPECT_NEAR(spacing(square_lattice(40, 1)), one, 1e-6 * one);
    EXPECT_NEAR(spacing(square_lattice(40, 64)), one, 1e-6 * one);
    StrandModel large;
    for (int i = 0; i < 40; ++i)
        for (int j = 0; j < 40; ++j)
            large.add(straight({1024 * (i + 0.5) / 40, 1024 * (j + 0.5) / 40, 0},
                               {1024 * (i + 0.5) / 40, 1024 * (j + 0.5) / 40, 1024}, 8),
                      0.1);
    EXPECT_NEAR(spacing(large.geometry()), 1024 * one, 1e-3 * 1024 * one);
}

TEST(StrandSpacing, OfALoneStrandIsACell) {
    // 32 cells of volume (1/32)^3 along a length of 1: sqrt(1/32^2). At a corner of the bounds nothing rounds away.
    StrandModel model;
    model.add(straight({0, 0, 0}, {0, 0, 1}, 7), 1e-4);
    EXPECT_NEAR(spacing(model.geometry()), 1.0 / 32, 1e-6);
    EXPECT_EQ(spacing(StrandModel().geometry()), 0);
}

TEST(StrandSpacing, IsTheSameForAnyNumberOfThreads) {
    const StrandGeometry strands = square_lattice(50, 3);
    const double one = spacing(strands);
    for (const int threads : {1, 2, 7}) with_threads(threads, [&] { EXPECT_EQ(spacing(strands), one); });
}

TEST(AutomaticVoxels, FollowTheSpacingWhereItIsWideAndTheDirectionsWhereItIsNot) {
    TransmittanceSettings settings;
    const StrandGeometry sparse = square_lattice(40), dense = square_lattice(300, 1);
    const GridFrame wide = make_grid_frame(sparse, settings);
    EXPECT_EQ(wide.reason, VoxelReason::spacing);
    EXPECT_DOUBLE_EQ(wide.voxel_size, 0.8 * spacing(sparse));
    EXPECT_EQ(make_grid_frame(dense, settings).reason, VoxelReason::resolution);
    for (const auto [directions, voxels] : {std::array{100.0, 256.0}, {25.0, 128.0}, {1.0, 32.0}, {4096.0, 512.0}}) {
        settings.directions = static_cast<int>(directions);
        const GridFrame frame = make_grid_frame(dense, settings);
        EXPECT_NEAR(frame.voxel_size, std::max(1 / voxels, 0.8 * spacing(dense)), 1e-6) << directions;
    }
    settings.voxels = 64;
    EXPECT_EQ(make_grid_frame(sparse, settings).reason, VoxelReason::asked);
}

}  // namespace
}  // namespace hairbake
