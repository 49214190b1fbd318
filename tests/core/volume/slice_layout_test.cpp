#include "core/volume/slice_layout.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/volume/volume_steps.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

StrandGeometry bent_strands() {
    Random random(13);
    StrandModel model;
    for (int s = 0; s < 400; ++s) {
        std::vector<Vec3d> points{random_point_in_box(random, {-1, -0.7, -0.4}, {1, 0.7, 0.4})};
        for (int k = 0; k < 5; ++k) points.push_back(points.back() + random_direction(random) * 0.05);
        model.add(points, 0.01);
    }
    return model.geometry();
}

class EveryAxis : public ::testing::TestWithParam<int> {
protected:
    StrandGeometry strands_ = bent_strands();
    HairVolume volume_ = volume_of(strands_, with_voxels(70));
    SliceLayout layout_ = make_slice_layout(volume_, GetParam(), Progress());
};

TEST_P(EveryAxis, HoldsEveryVertexOnceInItsSliceAndTexel) {
    const PointSlots slots = make_point_slots(volume_, layout_, vertices_of(volume_));
    EXPECT_TRUE(slots.all_inside);
    ASSERT_EQ(slots.begin.size(), static_cast<std::size_t>(layout_.slices) + 3);
    EXPECT_EQ(slots.begin[1], 0u);  // nothing is below the grid, nor above it
    EXPECT_EQ(slots.begin[layout_.slices + 1], slots.size());
    std::vector<int> seen(strands_.vertex_count());
    for (int s = 0; s < layout_.slices; ++s) {
        const std::uint32_t begin = slots.begin[s + 1], end = slots.begin[s + 2];
        EXPECT_EQ((end - begin) % 16, 0u);
        for (std::uint32_t slot = begin; slot < end; ++slot) {
            EXPECT_EQ(static_cast<int>(slots.s[slot]), s);
            const std::uint32_t tile = layout_.tile_begin[s] + static_cast<std::uint32_t>(slots.texel[slot]) / 64,
                                place = slots.point[slot];
            ASSERT_LT(tile, layout_.tile_begin[s + 1]);  // padding as well must read what exists
            if (place == PointSlots::no_point) continue;
            const std::uint32_t v = volume_.sorted.vertices[place];
            ++seen[v];
            const Vec3f g = volume_.frame.to_grid(strands_.positions[v]);
            EXPECT_EQ(slots.u[slot], g[layout_.axis_u]);
            EXPECT_EQ(slots.v[slot], g[layout_.axis_v]);
            EXPECT_EQ(slots.s[slot], g[layout_.axis]);
            const int texel = slots.texel[slot] % 64;
            EXPECT_EQ(layout_.tiles[tile].u + texel % 8, static_cast<int>(g[layout_.axis_u]));
            EXPECT_EQ(layout_.tiles[tile].v + texel / 8, static_cast<int>(g[layout_.axis_v]));
        }
    }
    EXPECT_EQ(seen, std::vector(strands_.vertex_count(), 1));
}

TEST_P(EveryAxis, HoldsPointsAnywhereInTheirRowWithTheirVectors) {
    Random random(14);
    std::vector<Vec3f> positions{Vec3f(std::nanf(""))}, vectors{Vec3f(1, 2, 3)};
    for (int k = 0; k < 1000; ++k) {
        positions.emplace_back(random_point_in_box(random, Vec3d(-60), Vec3d(150)));
        vectors.emplace_back(random_direction(random));
    }
    const PointSet points{.positions = positions, .model_index = {}, .vectors = vectors, .shadow = nullptr};
    const PointSlots slots = make_point_slots(volume_, layout_, points);
    EXPECT_FALSE(slots.all_inside);
    std::vector<int> seen(points.size());
    for (int row = 0; row < layout_.slices + 2; ++row)
        for (std::uint32_t slot = slots.begin[row]; slot < slots.begin[row + 1]; ++slot) {
            const std::uint32_t p = slots.point[slot];
            if (p == PointSlots::no_point) {
                EXPECT_EQ(slots.vector_x[slot] + slots.vector_y[slot] + slots.vector_z[slot], 0);
                continue;
            }
            ++seen[p];
            EXPECT_EQ(Vec3f(slots.vector_x[slot], slots.vector_y[slot], slots.vector_z[slot]), vectors[p]);
            const float s = positions[p][layout_.axis];
            const float slices = static_cast<float>(layout_.slices);
            EXPECT_EQ(row, !(s >= 0) ? 0 : s >= slices ? layout_.slices + 1 : 1 + static_cast<int>(s)) << s;
            bool occupied = true;
            for (int axis = 0; axis < 3; ++axis)
                occupied = occupied && positions[p][axis] >= 0 &&
                           positions[p][axis] < static_cast<float>(volume_.frame.voxels(axis));
            occupied = occupied && volume_.sorted.slot_of_brick[volume_.frame.brick_at(positions[p])] >= 0;
            EXPECT_EQ(slots.texel[slot] != PointSlots::no_texel, occupied);
        }
    EXPECT_EQ(seen, std::vector(points.size(), 1));
}

TEST_P(EveryAxis, HoldsEveryBricksTensorsTurnedIntoSlices) {
    EXPECT_NE(layout_.axis_u, layout_.axis);
    EXPECT_NE(layout_.axis_v, layout_.axis);
    EXPECT_LT(layout_.axis_u, layout_.axis_v);
    EXPECT_EQ(layout_.tiles.size(), 8 * volume_.sorted.brick_count());
    for (int s = 0; s < layout_.slices; ++s)
        for (std::uint32_t tile = layout_.tile_begin[s]; tile < layout_.tile_begin[s + 1]; ++tile)
            for (int texel = 0; texel < 64; ++texel) {
                std::array<int, 3> voxel{};
                voxel[layout_.axis] = s;
                voxel[layout_.axis_u] = layout_.tiles[tile].u + texel % 8;
                voxel[layout_.axis_v] = layout_.tiles[tile].v + texel / 8;
                const std::int32_t slot =
                    volume_.sorted.slot_of_brick[volume_.frame.brick_of(voxel[0], voxel[1], voxel[2])];
                ASSERT_GE(slot, 0);
                const int inside = GridFrame::voxel_in_brick(voxel[0], voxel[1], voxel[2]);
                for (int c = 0; c < 6; ++c)
                    ASSERT_EQ(layout_.tensors[(tile * 6u + c) * 64u + texel],
                              volume_.bricks.component(static_cast<std::size_t>(slot), c)[inside]);
            }
}

INSTANTIATE_TEST_SUITE_P(SliceLayout, EveryAxis, ::testing::Values(0, 1, 2));

}  // namespace
}  // namespace hairbake
