// The only test that compiles OpenVDB.
#include "core/volume/density_grid.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <fstream>

#include "core/base/error.h"
#include "core/volume/transmittance.h"
#include "tests/core/volume/volume_steps.h"
#include "tests/support/strand_models.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

StrandGeometry fibres_off_centre() {
    Random random(21);
    StrandModel model;
    fill(model, ball(1), Vec3d(-1), Vec3d(1), {.width = 0.01, .length = 0.4, .opacity = 0.7, .extinction = 1}, random);
    return model.geometry([](const Vec3d& p) { return p + Vec3d(10, -3, 0.7); });
}

openvdb::FloatGrid::Ptr read_density(const std::filesystem::path& file) {
    openvdb::initialize();
    openvdb::io::File in(file.string());
    in.open();
    return openvdb::gridPtrCast<openvdb::FloatGrid>(in.readGrid("density"));
}

TEST(DensityGrid, WrittenAndReadBackIsTheExtinctionThatTheSweepUsed) {
    const StrandGeometry strands = fibres_off_centre();
    const HairVolume volume = volume_of(strands, with_voxels(40));
    const GridFrame& frame = volume.frame;
    const TemporaryFolder folder;
    DensityGrid(volume).write(folder / "density.vdb");
    const auto grid = read_density(folder / "density.vdb");
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->getGridClass(), openvdb::GRID_FOG_VOLUME);
    std::uint64_t occupied = 0;
    for (int i = 0; i < frame.voxels(0); ++i)
        for (int j = 0; j < frame.voxels(1); ++j)
            for (int k = 0; k < frame.voxels(2); ++k) {
                const std::int32_t slot = volume.sorted.slot_of_brick[frame.brick_of(i, j, k)];
                const auto voxel = static_cast<std::size_t>(GridFrame::voxel_in_brick(i, j, k));
                const float trace = slot < 0 ? 0 : volume.bricks.trace(static_cast<std::size_t>(slot), voxel);
                occupied += trace > 0;
                const float density = grid->tree().getValue({i, j, k});
                ASSERT_EQ(density, trace * static_cast<float>(1 / frame.voxel_size));  // one float product: exact
                ASSERT_EQ(grid->tree().isValueOn({i, j, k}), trace > 0);
            }
    EXPECT_EQ(grid->activeVoxelCount(), occupied);
    EXPECT_EQ(volume.bricks.occupied_voxels, occupied);
    EXPECT_GT(occupied, 10'000u);
}

TEST(DensityGrid, TraceIsTheSumOfTheHalvesThatTheSweepLoads) {
    const HairVolume volume = volume_of(fibres_off_centre(), with_voxels(40));
    const auto value = [&](std::size_t brick, int component, std::size_t voxel) {
        const std::uint16_t bits = volume.bricks.component(brick, component)[voxel];  // a positive half float
        const int exponent = bits >> 10, fraction = bits & 1023;
        return exponent ? std::ldexp(1024 + fraction, exponent - 25) : std::ldexp(fraction, -24);
    };
    for (std::size_t b = 0; b < volume.sorted.brick_count(); ++b)
        for (std::size_t v = 0; v < 512; ++v)
            ASSERT_EQ(volume.bricks.trace(b, v), static_cast<float>(value(b, 0, v)) +
                                                     static_cast<float>(value(b, 1, v)) +
                                                     static_cast<float>(value(b, 2, v)));
}

TEST(DensityGrid, PlacesVoxelCentresInModelSpace) {
    const HairVolume volume = volume_of(fibres_off_centre(), with_voxels(40));
    const TemporaryFolder folder;
    DensityGrid(volume).write(folder / "density.vdb");
    const auto grid = read_density(folder / "density.vdb");
    EXPECT_DOUBLE_EQ(grid->voxelSize().x(), volume.frame.voxel_size);
    for (const auto [i, j, k] : {std::array{0, 0, 0}, {1, 2, 3}, {40, 17, 5}}) {
        const auto world = grid->indexToWorld(openvdb::Coord(i, j, k));
        const GridFrame& frame = volume.frame;
        EXPECT_NEAR(world.x(), double(frame.origin.x) + (i + 0.5) * frame.voxel_size, 1e-12);
        EXPECT_NEAR(world.y(), double(frame.origin.y) + (j + 0.5) * frame.voxel_size, 1e-12);
        EXPECT_NEAR(world.z(), double(frame.origin.z) + (k + 0.5) * frame.voxel_size, 1e-12);
    }
    // The lowest corner of the bounds, 9 -4 -0.3, lies in voxel 1 of each axis: its centre is within a voxel.
    EXPECT_NEAR(grid->indexToWorld(openvdb::Coord(1, 1, 1)).x(), 9, 0.06);
    EXPECT_NEAR(grid->indexToWorld(openvdb::Coord(1, 1, 1)).y(), -4, 0.06);
}

TEST(DensityGrid, TellsWhereVoxelsAreThatAreTooSmallForATransformOfOpenVdb) {
    const double scale = 1e-6;
    StrandModel model;
    model.add(straight({0, 0, 0}, {1, 2, 3}, 9), 0.001);
    const StrandGeometry strands = model.geometry([&](const Vec3d& p) { return p * scale; }, scale);
    const HairVolume volume = volume_of(strands, with_voxels(32));
    const TemporaryFolder folder;
    DensityGrid(volume).write(folder / "density.vdb");
    const auto grid = read_density(folder / "density.vdb");
    EXPECT_EQ(grid->metaValue<double>("voxel_size"), volume.frame.voxel_size);
    const auto centre = grid->metaValue<openvdb::Vec3d>("first_voxel_centre");
    EXPECT_NEAR(centre.x(), double(volume.frame.origin.x) + volume.frame.voxel_size / 2, 1e-20);
}

/// Integral of the exported density over opacity * width * length of the strands.
double mass_ratio(const StrandModel& model, double voxel_size) {
    const StrandGeometry strands = model.geometry();
    Progress progress;
    TransmittanceScene scene{strands};
    scene.keep_density = true;
    const Transmittance baked = bake_transmittance_volume(scene, with_voxel_size(voxel_size, 1), progress);
    const TemporaryFolder folder;
    baked.density->write(folder / "density.vdb");
    double mass = 0, expected = 0;
    const auto grid = read_density(folder / "density.vdb");
    for (auto value = grid->cbeginValueOn(); value; ++value) mass += double(*value) * std::pow(baked.voxel_size, 3);
    for (std::size_t i = 0; i + 1 < strands.vertex_count(); ++i)
        if (strands.segments[i] == Segment::solid)
            expected += 0.5 * double(strands.opacities[i] + strands.opacities[i + 1]) * 0.5 *
                        double(strands.widths[i] + strands.widths[i + 1]) *
                        length(Vec3d(strands.positions[i + 1]) - Vec3d(strands.positions[i]));
    return mass / expected;
}

TEST(DensityGrid, HoldsOpacityTimesWidthTimesLengthOfCombedStrands) {
    // Parallel strands: the mixing factor is 1, the disjoint share adds 0.381 opacity w/h; halves round by 2^-12.
    for (const double opacity : {1.0, 0.5}) {
        Random random(22);
        StrandModel model;
        for (int s = 0; s < 500; ++s) {
            const Vec3d p = random_point_in_ball(random, 1);
            model.add(straight(p, p + Vec3d(0.3, 0.1, 0.2), 5), 0.01, opacity);
        }
        EXPECT_NEAR(mass_ratio(model, 0.05), 1 + 0.381 * opacity * 0.2, 2e-3) << opacity;
    }
}

TEST(DensityGrid, HoldsIsotropicStrandsLessTheMixingFactor) {
    // Between pi/4 sqrt(3/2) = 0.9619 (isotropic voxels) and 1 (voxels with one strand), times 1 + 0.381 w/h = 1.0076.
    // With some 25 fibres a voxel tr T^2/tr^2 is 1/3 + 2/3 x 1/25 or a little more: 0.9619 + 0.0381 x 0.04 to 0.06.
    Random random(23);
    StrandModel model;
    fill(model, box(Vec3d(0), Vec3d(1)), Vec3d(0), Vec3d(1), {.width = 0.002, .length = 0.3, .extinction = 4}, random);
    const double ratio = mass_ratio(model, 0.1) / (1 + 0.381 * 0.02);
    EXPECT_GT(ratio, 0.9619);
    EXPECT_LT(ratio, 0.9619 + 0.0381 * 0.1);
}

TEST(DensityGrid, GivesTheSameBytesEachTimeAndATagOfItsContents) {
    // OpenVDB itself puts a random UUID into each file: 36 characters from byte 21.
    const HairVolume volume = volume_of(fibres_off_centre(), with_voxels(40)),
                     coarser = volume_of(fibres_off_centre(), with_voxels(32));
    const DensityGrid grid(volume);
    const std::string bytes = grid.encode();
    EXPECT_TRUE(bytes == grid.encode());
    EXPECT_TRUE(bytes == DensityGrid(volume).encode());
    const TemporaryFolder folder;
    grid.write(folder / "density.vdb");
    openvdb::initialize();
    openvdb::io::File in((folder / "density.vdb").string());
    in.open();
    EXPECT_EQ(in.getUniqueTag(), bytes.substr(21, 36));
    EXPECT_TRUE(in.hasGrid("density"));
    const DensityGrid other(coarser);
    EXPECT_NE(other.encode().substr(21, 36), bytes.substr(21, 36));
}

TEST(DensityGrid, CannotBeWrittenWhereThereIsNoFolder) {
    const HairVolume volume = volume_of(fibres_off_centre(), with_voxels(40));
    const DensityGrid grid(volume);
    try {
        grid.write("/nonexistent/folder/density.vdb");
        ADD_FAILURE() << "was written";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::out_of_resources);
    }
}

}  // namespace
}  // namespace hairbake
