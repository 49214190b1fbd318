#include "core/volume/strand_pieces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "tests/core/volume/volume_steps.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

StrandGeometry tangle() {
    Random random(12);
    StrandModel model;
    for (int s = 0; s < 300; ++s) {
        std::vector<Vec3d> points{random_point_in_ball(random, 1)};
        for (int k = 0; k < s % 7; ++k)
            points.push_back(points.back() + random_direction(random) * random.next(0, 0.6));
        if (s % 5 == 0) points.push_back(points.back());
        model.add(points, random.next(0.001, 0.02), s % 11 == 0 ? 0.0 : random.next());
    }
    return model.geometry();
}

TEST(SortedStrands, HoldEveryVertexOnceInItsBrickInModelOrder) {
    const StrandGeometry strands = tangle();
    const HairVolume volume = volume_of(strands, with_voxels(50));
    std::vector<int> seen(strands.vertex_count());
    for (std::size_t b = 0; b < volume.sorted.brick_count(); ++b)
        for (std::uint32_t i = volume.sorted.vertex_begin[b]; i < volume.sorted.vertex_begin[b + 1]; ++i) {
            const std::uint32_t v = volume.sorted.vertices[i];
            ++seen[v];
            EXPECT_EQ(volume.frame.brick_at(volume.frame.to_grid(strands.positions[v])), volume.sorted.bricks[b]);
            if (i > volume.sorted.vertex_begin[b]) {
                EXPECT_LT(volume.sorted.vertices[i - 1], v);
            }
        }
    EXPECT_EQ(seen, std::vector(strands.vertex_count(), 1));
}

TEST(SortedStrands, CutEverySolidSegmentWithAnOpacityIntoPiecesOfAtMostAVoxel) {
    const StrandGeometry strands = tangle();
    const HairVolume volume = volume_of(strands, with_voxels(50));
    const GridFrame& frame = volume.frame;
    std::map<std::uint32_t, std::vector<StrandPiece>> pieces;
    for (const StrandPiece& piece : volume.sorted.pieces) pieces[piece.segment].push_back(piece);
    for (std::uint32_t i = 0; i < strands.vertex_count(); ++i) {
        const bool solid = strands.segments[i] == Segment::solid;
        const float opacity = solid ? 0.5f * (strands.opacities[i] + strands.opacities[i + 1]) : 0;
        ASSERT_EQ(pieces.contains(i), opacity > 0);
        if (!(opacity > 0)) continue;
        const Vec3d a(frame.to_grid(strands.positions[i])), b(frame.to_grid(strands.positions[i + 1]));
        Vec3d whole, moment;
        for (const StrandPiece& piece : pieces[i]) {
            EXPECT_LE(length(piece.step), 1.00001f);
            const float width = 0.5f * (strands.widths[i] + strands.widths[i + 1]);
            EXPECT_NEAR(piece.weight, double(opacity * width) / frame.voxel_size, 1e-7);
            whole += Vec3d(piece.step);
            moment += Vec3d(piece.centre) / double(pieces[i].size());
        }
        // Together the pieces are the segment, equally long: their steps add up, their centres average to its middle.
        // Grid coordinates up to 53 are rounded by 4e-6.
        EXPECT_LT(length(whole - (b - a)), 1e-4);
        EXPECT_LT(length(moment - (a + b) / 2.0), 1e-4);
        EXPECT_EQ(pieces[i].size(), static_cast<std::size_t>(std::max(1.0f, std::ceil(length(Vec3f(b - a))))));
    }
}

TEST(SortedStrands, PutEveryPieceIntoItsBrickAndVoxel) {
    const HairVolume volume = volume_of(tangle(), with_voxels(50));
    const SortedStrands& sorted = volume.sorted;
    std::size_t count = 0;
    for (std::size_t b = 0; b < sorted.brick_count(); ++b) {
        EXPECT_EQ(sorted.slot_of_brick[sorted.bricks[b]], static_cast<std::int32_t>(b));
        if (b > 0) {
            EXPECT_LT(sorted.bricks[b - 1], sorted.bricks[b]);
        }
        for (std::size_t voxel = 0; voxel < 512; ++voxel)
            for (const StrandPiece& piece : sorted.pieces_in(b, voxel)) {
                ++count;
                EXPECT_EQ(volume.frame.brick_at(piece.centre), sorted.bricks[b]);
                EXPECT_EQ(piece.voxel_in_brick(), static_cast<int>(voxel));
            }
    }
    EXPECT_EQ(count, sorted.pieces.size());
    EXPECT_EQ(sorted.slot_at(volume.frame, -1, 0, 0), -1);
    EXPECT_EQ(sorted.slot_at(volume.frame, 0, volume.frame.bricks[1], 0), -1);
}

TEST(SortedStrands, AreTheSameForAnyNumberOfThreads) {
    const StrandGeometry strands = tangle();
    const HairVolume one = volume_of(strands, with_voxels(50));
    for (const int threads : {1, 2, 7})
        with_threads(threads, [&] {
            const HairVolume other = volume_of(strands, with_voxels(50));
            EXPECT_EQ(other.sorted.vertices, one.sorted.vertices);
            EXPECT_EQ(other.sorted.voxel_end, one.sorted.voxel_end);
            EXPECT_EQ(other.bricks.half, one.bricks.half);
            ASSERT_EQ(other.sorted.pieces.size(), one.sorted.pieces.size());
            for (std::size_t k = 0; k < one.sorted.pieces.size(); ++k)
                EXPECT_EQ(other.sorted.pieces[k].segment, one.sorted.pieces[k].segment);
        });
}

}  // namespace
}  // namespace hairbake
