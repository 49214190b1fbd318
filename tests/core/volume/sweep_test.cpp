#include "core/volume/sweep.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/visibility/direction_set.h"
#include "core/volume/direction_sweep.h"
#include "core/volume/hemisphere_reader.h"
#include "tests/core/volume/volume_steps.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

TEST(SweepScale, NeverOverflowsAndIsTheLargestPowerOfTwoButOne) {
    // `directions` terms of magnitude 1, each group's sum rounded by 1/2, stay below 2^31; a term is kept to 2^-18.
    for (int n = 1; n <= 4096; ++n) {
        const double scale = double(sweep_scale(static_cast<std::size_t>(n)));
        EXPECT_EQ(std::exp2(std::floor(std::log2(scale))), scale);
        EXPECT_LT(scale * n + 0.5 * n, 2147483648.0) << n;
        EXPECT_GE(scale * n, 536870912.0) << n;
    }
}

TEST(Sweep, SumsOfManyFullyLitDirectionsDoNotOverflow) {
    // Nothing is in the way: every direction brings 1 to each lane.
    StrandModel model;
    for (int k = 0; k < 40; ++k) model.add({{0.1 * k, 0, 0.03 * k}}, 0.01);
    for (const int directions : {1, 2, 3, 4, 5, 7, 8, 9, 31, 100, 128, 1000, 4096})
        for (const float a : bake(model.geometry(), with_voxels(32, directions))) EXPECT_NEAR(a, 1, 2e-6) << directions;
}

TEST(Sweep, EveryDirectionIsInOneGroup) {
    // A = 1 where nothing is only if all directions of a set are swept, once each; stratified and random sets put
    // uneven numbers on the six sides. Direction 0 of a set of one is (1, 0, 0), on an axis.
    StrandModel model;
    for (int k = 0; k < 3; ++k) model.add({{0.5 * k, 0.1 * k, 0}}, 0.01);
    TransmittanceSettings settings = with_voxels(32);
    for (const DirectionSet set : {DirectionSet::fibonacci, DirectionSet::stratified, DirectionSet::random})
        for (const int side : {1, 2, 3, 5, 8, 10}) {
            settings.direction_set = set;
            settings.directions = side * side;
            for (const float a : bake(model.geometry(), settings)) EXPECT_NEAR(a, 1, 1e-6);
        }
}

/// Strands along z, one in the middle of every column of a block of n x n columns, n long, all of width w: every voxel
/// of the block holds the same.
struct Block {
    static constexpr int n = 40;
    static constexpr double w = 0.05;
    StrandGeometry strands;
    std::uint32_t first_probe;

    Block() {
        StrandModel model;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) model.add({{i + 0.5, j + 0.5, 0}, {i + 0.5, j + 0.5, n}}, w);
        model.add_box(Vec3d(0), Vec3d(n));
        first_probe = model.add_probes({{20.5, 20.5, 20.5}, {3.2, 17.7, 30.1}, {39.9, 39.9, 0.1}, {0.01, 20, 20}});
        strands = model.geometry();
    }
};

/// Shortest and longest way through the block from places up to a voxel beside p.
std::pair<double, double> ways_out(const Vec3d& p, const Vec3d& l) {
    std::pair<double, double> ways{1e9, 0};
    for (int k = 0; k < 27; ++k) {
        const Vec3d q = p + Vec3d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
        const Interval inside = box(Vec3d(0), Vec3d(Block::n))(q, l);
        const double way = std::max(0.0, inside.end - std::max(0.0, inside.begin));
        ways = {std::min(ways.first, way), std::max(ways.second, way)};
    }
    return ways;
}

TEST(Sweep, OfAUniformCombedBlockIsTheExponentialOfTheWay) {
    // Optical depth of a voxel edge across the strands: w/h (1 + share w/h), share 0.381; times sin(angle) times the
    // way out of the block. The nearest ray is half a voxel beside the vertex at most, and half a voxel beside itself
    // in a slice, on either axis. Halves are rounded by 2^-11.
    const Block block;
    const HairVolume volume = volume_of(block.strands, with_voxel_size(1));
    const double across = Block::w * (1 + 0.381 * Block::w);
    Random random(14);
    for (int k = 0; k < 200; ++k) {
        const Vec3d l = random_direction(random);
        const auto t = sweep_one(volume, l);
        const double sine = std::sqrt(1 - l.z * l.z);
        for (std::uint32_t p = block.first_probe; p < block.first_probe + 4; ++p) {
            const auto [least, most] = ways_out(Vec3d(block.strands.positions[p]), l);
            EXPECT_LE(t[p], std::exp(-across * sine * least * 0.999) + 1e-6) << l.x << " " << l.y << " " << l.z;
            EXPECT_GE(t[p], std::exp(-across * sine * most * 1.001) - 1e-6) << l.x << " " << l.y << " " << l.z;
        }
    }
}

TEST(Sweep, AlongTheAxesIsExact) {
    // Rays stay in their column: 19.5 voxels above and below, of the strands' full depth; along the strands nothing.
    const Block block;
    const HairVolume volume = volume_of(block.strands, with_voxel_size(1));
    const double across = Block::w * (1 + 0.381 * Block::w);
    for (const Vec3d& l : {Vec3d(1, 0, 0), Vec3d(-1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, -1, 0)}) {
        const double way = l.x + l.y > 0 ? 19.5 : 20.5;
        EXPECT_NEAR(sweep_one(volume, l)[block.first_probe], std::exp(-across * way), 0.001);
    }
    for (const double sign : {1.0, -1.0}) EXPECT_NEAR(sweep_one(volume, Vec3d(0, 0, sign))[block.first_probe], 1, 1e-6);
}

TEST(Sweep, OfTwoDirectionsTogetherIsTheSumOfBoth) {
    const Block block;
    const HairVolume volume = volume_of(block.strands, with_voxel_size(1));
    const std::vector<Vec3d> both{normalized(Vec3d(1, 0.3, 0.2)), normalized(Vec3d(1, -0.8, 0.6))};
    const PointSet vertices = vertices_of(volume);
    // T, T x, T y, T z, in the fixed point of two directions; the last in a coarser one.
    std::vector<float> weights;
    for (const Vec3d& l : both)
        for (const double w : {1.0, l.x, l.y, l.z}) weights.push_back(static_cast<float>(w));
    const float scale = sweep_scale(2);
    const WeightReader reader(vertices, weights, {scale, scale, scale, scale / 1024});
    const std::vector<std::uint32_t> walk{0, 1};
    const auto sums = walk_sums(volume, both, walk, reader);
    const auto a = sweep_one(volume, both[0]), b = sweep_one(volume, both[1]);
    for (std::size_t place = 0; place < vertices.size(); ++place) {
        const double t0 = double(a[volume.sorted.vertices[place]]), t1 = double(b[volume.sorted.vertices[place]]);
        const double* sum = &sums[4 * place];
        EXPECT_NEAR(sum[0], t0 + t1, 1e-6);  // floats near 1
        EXPECT_NEAR(sum[1], t0 * both[0].x + t1 * both[1].x, 1e-6);
        EXPECT_NEAR(sum[2], t0 * both[0].y + t1 * both[1].y, 1e-6);
        EXPECT_NEAR(sum[3], t0 * both[0].z + t1 * both[1].z, 1e-6 + 512 / double(scale));  // half a unit
    }
}

TEST(Sweep, OfManyPointSetsAndReadersGivesEachWhatItGivesAlone) {
    // Two readers share the vertices; the third reads points inside and outside the grid, with normals.
    const Block block;
    const HairVolume volume = volume_of(block.strands, with_voxel_size(1));
    const std::vector<Vec3d> directions = make_directions(DirectionSet::fibonacci, 23, 0);
    const PointSet vertices = vertices_of(volume);
    Random random(15);
    std::vector<Vec3f> positions, normals;
    for (int k = 0; k < 500; ++k) {
        positions.emplace_back(random_point_in_box(random, Vec3d(-20), Vec3d(70)));
        normals.emplace_back(random_direction(random));
    }
    const PointSet others{.positions = positions, .model_index = {}, .vectors = normals, .shadow = nullptr};
    const WeightReader ones(vertices, std::vector<float>(directions.size(), 1), {sweep_scale(directions.size())});
    const WeightReader halves(vertices, std::vector<float>(2 * directions.size(), 0.5f), {1024, 65536});
    const HemisphereReader hemisphere(others, directions);
    const SweepReader* all[] = {&halves, &hemisphere, &ones};
    Progress progress;
    const auto together = sweep_directions(volume, directions, all, progress);
    for (std::size_t r = 0; r < 3; ++r) {
        const auto alone = sweep_directions(volume, directions, std::span(&all[r], 1), progress);
        ASSERT_EQ(together[r].points(), all[r]->points().size());
        for (std::size_t p = 0; p < together[r].points(); ++p)
            for (std::size_t c = 0; c < together[r].components(); ++c)
                ASSERT_EQ(together[r].of(p)[c], alone[0].of(p)[c]) << r << " " << p << " " << c;
    }
    // A group of up to four directions is rounded once: 23 directions are at least 6 groups on six sides, at most 12.
    for (std::size_t p = 0; p < vertices.size(); ++p)
        ASSERT_NEAR(together[0].of(p)[1] / 65536.0, together[2].of(p)[0] / double(sweep_scale(23)) / 2,
                    12 * 0.5 / 65536 + 1e-5);
}

}  // namespace
}  // namespace hairbake
