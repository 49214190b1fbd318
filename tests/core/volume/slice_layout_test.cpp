#include "core/volume/slice_layout.h"

#include <gtest/gtest.h>

#include "tests/core/volume/stages.h"
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
    Stages stages_{strands_, with_voxels(70)};
    SliceLayout layout_ = [&] {
        Progress progress;
        return make_slice_layout(stages_.frame, stages_.sorted, stages_.bricks, GetParam(), progress);
    }();
};

TEST_P(EveryAxis, HoldsEveryVertexOnceInItsSliceAndTexel) {
    std::vector<int> seen(strands_.vertex_count());
    for (int s = 0; s < layout_.slices; ++s) {
        const std::uint32_t begin = layout_.slot_begin[s], end = layout_.slot_begin[s + 1];
        EXPECT_EQ((end - begin) % 16, 0u);
        for (std::uint32_t slot = begin; slot < end; ++slot) {
            EXPECT_EQ(static_cast<int>(layout_.slot_s[slot]), s);
            const std::uint32_t tile = layout_.tile_begin[s] + layout_.slot_texel[slot] / 64,
                                place = layout_.slot_vertex[slot];
            ASSERT_LT(tile, layout_.tile_begin[s + 1]);  // padding as well must read what exists
            if (place == SliceLayout::no_vertex) continue;
            const std::uint32_t v = stages_.sorted.vertices[place];
            ++seen[v];
            const Vec3f g = stages_.frame.to_grid(strands_.positions[v]);
            EXPECT_EQ(layout_.slot_u[slot], g[layout_.axis_u]);
            EXPECT_EQ(layout_.slot_v[slot], g[layout_.axis_v]);
            EXPECT_EQ(layout_.slot_s[slot], g[layout_.axis]);
            const auto texel = static_cast<int>(layout_.slot_texel[slot] % 64);
            EXPECT_EQ(layout_.tiles[tile].u + texel % 8, static_cast<int>(g[layout_.axis_u]));
            EXPECT_EQ(layout_.tiles[tile].v + texel / 8, static_cast<int>(g[layout_.axis_v]));
        }
    }
    EXPECT_EQ(seen, std::vector(strands_.vertex_count(), 1));
}

TEST_P(EveryAxis, HoldsEveryBricksTensorsTurnedIntoSlices) {
    EXPECT_NE(layout_.axis_u, layout_.axis);
    EXPECT_NE(layout_.axis_v, layout_.axis);
    EXPECT_LT(layout_.axis_u, layout_.axis_v);
    EXPECT_EQ(layout_.tiles.size(), 8 * stages_.sorted.brick_count());
    for (int s = 0; s < layout_.slices; ++s)
        for (std::uint32_t tile = layout_.tile_begin[s]; tile < layout_.tile_begin[s + 1]; ++tile)
            for (int texel = 0; texel < 64; ++texel) {
                std::array<int, 3> voxel{};
                voxel[layout_.axis] = s;
                voxel[layout_.axis_u] = layout_.tiles[tile].u + texel % 8;
                voxel[layout_.axis_v] = layout_.tiles[tile].v + texel / 8;
                const std::int32_t slot =
                    stages_.sorted.slot_of_brick[stages_.frame.brick_of(voxel[0], voxel[1], voxel[2])];
                ASSERT_GE(slot, 0);
                const int inside = GridFrame::voxel_in_brick(voxel[0], voxel[1], voxel[2]);
                for (int c = 0; c < 6; ++c)
                    ASSERT_EQ(layout_.tensors[(tile * 6u + c) * 64u + texel],
                              stages_.bricks.component(static_cast<std::size_t>(slot), c)[inside]);
            }
}

INSTANTIATE_TEST_SUITE_P(SliceLayout, EveryAxis, ::testing::Values(0, 1, 2));

}  // namespace
}  // namespace hairbake
