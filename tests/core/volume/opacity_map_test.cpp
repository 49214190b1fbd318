// One deep opacity map: drawing and look-ups.
#include "core/volume/opacity_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/volume/texel_walk.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

OpacityMapSettings maps(int layers, double spacing, int resolution) { return {layers, spacing, resolution}; }

/// A map of a model from one direction, and the arguments of its look-ups.
struct Drawn {
    StrandGeometry strands;
    OpacityView view;
    std::vector<LightPoint> points;
    OpacityMap map;

    Drawn(const StrandModel& model, const Vec3d& l, const OpacityMapSettings& settings)
        : strands(model.geometry()), view(make_opacity_view(strands.positions, l, settings, 1e-6)) {
        draw();
    }
    void draw() {
        points.clear();
        for (const Vec3f& p : strands.positions) points.push_back(view.project(p));
        Progress progress;
        map.draw(view, strands, points, progress);
    }
    float depth(std::uint32_t v) const { return map.optical_depth(strands, points, v); }
};

StrandModel random_strands(int count, double opacity) {
    Random random(5);
    StrandModel model;
    for (int s = 0; s < count; ++s) {
        std::vector<Vec3d> points{random_point_in_ball(random, 1)};
        Vec3d direction = random_direction(random);
        for (int k = 0; k < 10; ++k) {
            direction = normalized(direction + random_direction(random) * 0.5);
            points.push_back(points.back() + direction * 0.1);
        }
        model.add(points, 0.01, opacity);
    }
    return model;
}

TEST(OpacityView, HoldsEveryPointWithAMarginAndSpansTheDepthWithItsLayers) {
    const StrandGeometry strands = random_strands(50, 1).geometry();
    Random random(3);
    for (int k = 0; k < 50; ++k) {
        const Vec3d l =
            k < 6 ? Vec3d(k == 0, k == 1, k == 2) - Vec3d(k == 3, k == 4, k == 5) : random_direction(random);
        const OpacityView view = make_opacity_view(strands.positions, l, maps(3, 2, 64), 1e-6);
        EXPECT_NEAR(dot(view.u, view.v), 0, 1e-12);
        EXPECT_NEAR(length(cross(view.u, view.v) - view.l), 0, 1e-12);
        EXPECT_EQ(std::max(view.width, view.height), 64);
        float deepest = 0;
        for (const Vec3f& p : strands.positions) {
            const LightPoint q = view.project(p);
            EXPECT_GE(std::min(q.x, q.y), 0.999f);
            EXPECT_LE(q.x, static_cast<float>(view.width) - 0.999f);
            EXPECT_LE(q.y, static_cast<float>(view.height) - 0.999f);
            EXPECT_GE(q.z, 0);
            deepest = std::max(deepest, q.z);
        }
        // 1 : 2 : 4 end at 1/7, 3/7 and 7/7 of the depth.
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(view.layer_end[static_cast<std::size_t>(i)], deepest * float((2 << i) - 1) / 7,
                        1e-4f * deepest);
    }
}

TEST(TexelWalk, CutsALineIntoPartsThatLieEachInTheirTexel) {
    Random random(11);
    for (int k = 0; k < 2000; ++k) {
        const auto coordinate = [&] {
            const double c = random.next(0, 40);  // every third one on an edge of a texel
            return static_cast<float>(k % 3 == 0 ? std::floor(c) : c);
        };
        const LightPoint a{coordinate(), coordinate(), 0}, b{coordinate(), coordinate(), 0};
        float end = 0;
        const bool arrived = walk_texels(a, b, [&](int x, int y, float t0, float t1) {
            EXPECT_EQ(t0, end);
            EXPECT_GE(t1, t0);
            end = t1;
            const float middle = 0.5f * (t0 + t1), px = a.x + middle * (b.x - a.x), py = a.y + middle * (b.y - a.y);
            EXPECT_NEAR(px, static_cast<float>(x) + 0.5f, 0.5001f);
            EXPECT_NEAR(py, static_cast<float>(y) + 0.5f, 0.5001f);
            return true;
        });
        EXPECT_TRUE(arrived);
        EXPECT_EQ(end, 1);
    }
}

TEST(OpacityMap, HoldsTheProjectedAreaTimesOpacityWhateverItsResolution) {
    // A strand of width w and direction d covers w |d x l| across the light. 500 segments, summed in floats: 1e-4.
    const StrandModel model = random_strands(50, 0.7);
    const Vec3d l = normalized(Vec3d(1, 2, -3));
    for (const int resolution : {16, 64, 512}) {
        const Drawn drawn(model, l, maps(3, 2, resolution));
        double expected = 0, found = 0;
        for (std::size_t i = 0; i < drawn.strands.vertex_count(); ++i)
            if (drawn.strands.segments[i] == Segment::solid)
                expected += 0.7 * 0.01 *
                            length(cross(Vec3d(drawn.strands.positions[i + 1]) - Vec3d(drawn.strands.positions[i]), l));
        for (int y = 0; y < drawn.view.height; ++y)
            for (int x = 0; x < drawn.view.width; ++x)
                found += drawn.map.coverage(x, y) * drawn.view.texel_size * drawn.view.texel_size;
        EXPECT_NEAR(found / expected, 1, 1e-4) << resolution;
    }
}

TEST(OpacityMap, CrossingStrandsShadowTheLowerOneByTheUppersCoverage) {
    // Light from +z. The upper strand runs along x through the texels of one row and covers w / texel of each. The
    // vertex of the lower strand under it lies as deep as the layers reach: its optical depth is that coverage times
    // the row's weight in the bilinear blend, without its own strand. Nothing shadows the upper strand.
    for (const double y : {0.0, 0.013, 0.31, -0.47})
        for (const double opacity : {1.0, 0.25}) {
            StrandModel model;
            const auto upper = model.add({{-1, y, 1}, {0, y, 1}, {1, y, 1}}, 0.002, opacity);
            const auto lower = model.add({{0, -1, 0}, {0, y, 0}, {0, 1, 0}}, 0.002, opacity);
            const Drawn drawn(model, {0, 0, 1}, maps(3, 2, 64));
            const float row =
                dot(drawn.view.v, Vec3d(0, 1, 0)) != 0 ? drawn.points[lower + 1].y : drawn.points[lower + 1].x;
            const float weight = 1 - std::abs(row - std::floor(row) - 0.5f);
            const double expected = opacity * 0.002 / drawn.view.texel_size * weight;
            EXPECT_NEAR(drawn.depth(lower + 1), expected, 1e-4 * expected);
            EXPECT_NEAR(drawn.depth(upper + 1), 0, 1e-6);
        }
}

TEST(OpacityMap, LayersInterpolateBetweenTheirEndsAndStayConstantBehindTheLast) {
    // A stack of strands along x, one under the other at the depths 0, 1, 2 ... 70 (in texels of 1/30), each covering
    // c = w / texel of the texels of one row. Layers that end after 7, 21 and 49 texels hold the strands at depths up
    // to there, 8 and 22 of them, and the last one all 71; between the ends the depth is linear. The probes lie in
    // the middle of the row.
    const double texel = 1.0 / 30, w = 0.001;
    StrandModel model;
    for (int k = 0; k <= 70; ++k) model.add({{-1, 0.5 * texel, -k * texel}, {1, 0.5 * texel, -k * texel}}, w);
    std::vector<Vec3d> places;
    for (const double z : {-0.5, 3.5, 7.01, 14.0, 30.0, 48.9, 60.0, 70.0})
        places.push_back({0.01, 0.5 * texel, -z * texel});
    const auto probe = model.add_probes(places);
    Drawn drawn(model, {0, 0, 1}, maps(3, 2, 64));
    drawn.view.texel_size = texel;
    drawn.view.scale = 1 / texel;
    drawn.view.origin_u = drawn.view.origin_v = -32 * texel;
    drawn.view.origin_z = -texel;
    drawn.view.width = drawn.view.height = 65;
    drawn.view.layer_end = {7.001f, 21.001f, 49.001f};
    drawn.draw();
    const double c = w / texel;
    const auto between = [](double a, double b, double t) { return a + (b - a) * t; };
    const double expected[] = {
        0, 8 * 3.5 / 7, 8, between(8, 22, 7.0 / 14), between(22, 71, 9.0 / 28), between(22, 71, 27.9 / 28), 71, 71};
    for (std::uint32_t k = 0; k < std::size(expected); ++k)
        EXPECT_NEAR(drawn.depth(probe + k), c * expected[k], 0.01 * c) << k;
}

TEST(OpacityMap, OfAHomogeneousMediumIsExactWithinTheLayers) {
    // A unit cube of isotropic fibres, light from +z: optical depth = extinction * depth. The medium's length is random
    // by about 1 % and 20 x 20 probes stand for a depth: 4 %. Above the first end the line begins at the first fibre of
    // a texel, not at the face: about one crossing less, w d / texel^2 = 0.05.
    Random random(2);
    StrandModel model;
    fill(model, box(Vec3d(0), Vec3d(1)), Vec3d(0), Vec3d(1), {.width = 0.002, .length = 0.2, .extinction = 2}, random);
    const std::vector<double> depths{0.1, 0.4, 0.6, 0.8, 1.0};
    std::vector<std::uint32_t> first;
    for (const double depth : depths) {
        std::vector<Vec3d> probes;
        for (int i = 0; i < 400; ++i) probes.push_back({0.1 + 0.04 * (i % 20), 0.1 + 0.04 * (i / 20), 1 - depth});
        first.push_back(model.add_probes(probes));
    }
    const Drawn drawn(model, {0, 0, 1}, maps(4, 1, 32));
    for (std::size_t k = 0; k < depths.size(); ++k) {
        double mean = 0;
        for (std::uint32_t i = 0; i < 400; ++i) mean += drawn.depth(first[k] + i) / 400.0;
        EXPECT_NEAR(mean, 2 * depths[k], 0.08 * depths[k] + (depths[k] < 0.25 ? 0.05 : 0.01)) << depths[k];
    }
}

}  // namespace
}  // namespace hairbake
