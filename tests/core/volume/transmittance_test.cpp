#include "core/volume/transmittance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "core/base/error.h"
#include "core/reference/error_bar.h"
#include "core/volume/density_grid.h"
#include "tests/core/volume/tuft.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

struct Difference {
    double mean = 0, rms = 0, worst = 0;
};
Difference difference(const std::vector<float>& a, const std::vector<float>& b) {
    Difference d;
    EXPECT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
        const double e = double(a[k]) - double(b[k]);
        d.mean += e / static_cast<double>(a.size());
        d.rms += e * e / static_cast<double>(a.size());
        d.worst = std::max(d.worst, std::abs(e));
    }
    d.rms = std::sqrt(d.rms);
    return d;
}

TEST(Transmittance, IsBitEqualWhenTheModelIsScaledByAPowerOfTwo) {
    // Every step is a product or a quotient of lengths: powers of two change exponents only.
    const StrandModel model = tuft();
    const auto expected = bake(model.geometry(), with_voxels(64));
    for (const double scale : {0x1p-40, 0x1p-10, 0x1p10, 0x1p40})
        EXPECT_EQ(bake(model.geometry([&](const Vec3d& p) { return p * scale; }, scale), with_voxels(64)), expected)
            << scale;
}

TEST(Transmittance, IsNearlyTheSameAtAnyScale) {
    // Positions in grid space move by some 1e-5 of a voxel: few vertices or pieces change their voxel (one in 30,000 on
    // each axis), each then brings at most its own optical depth, w/h = 0.4, and most see none of it.
    const StrandModel model = tuft();
    const auto expected = bake(model.geometry(), with_voxels(64));
    for (const double scale : {1e-15, 1e-3, 1e3, 1e15}) {
        const auto a = bake(model.geometry([&](const Vec3d& p) { return p * scale; }, scale), with_voxels(64));
        EXPECT_LT(difference(a, expected).rms, 1e-3) << scale;
        int moved = 0;
        for (std::size_t v = 0; v < a.size(); ++v) moved += std::abs(a[v] - expected[v]) > 1e-4f;
        EXPECT_LT(moved, 100) << scale;
    }
}

TEST(Transmittance, IsBitEqualWhenTheModelMovesByWhatFloatsHold) {
    // Positions are multiples of 2^-16 and below 4, so that adding 8 is exact, as is a voxel size of 2^-5.
    const StrandModel model = tuft();
    const auto rounded = [](const Vec3d& p) {
        return Vec3d(std::round(p.x * 65536) / 65536, std::round(p.y * 65536) / 65536, std::round(p.z * 65536) / 65536);
    };
    const auto a = bake(model.geometry(rounded), with_voxel_size(0x1p-5));
    EXPECT_EQ(
        bake(model.geometry([&](const Vec3d& p) { return rounded(p) + Vec3d(8, -8, 16); }), with_voxel_size(0x1p-5)),
        a);
}

/// RMSE of a bake against the tracer at 400 vertices.
double rmse_of(const StrandGeometry& strands, const std::vector<float>& a) {
    Progress progress;
    const StrandScene scene(strands, progress);
    return measure_error(scene, a, 400, 1, progress).outside.rmse;
}

TEST(Transmittance, TurnsWithTheModelWithinItsOwnError) {
    // Two bakes of one truth: they differ by no more than both their errors together (triangle inequality), which the
    // tracer measures at 400 vertices (to 10 %, fourth moments of such errors). Means differ by less than 2 x 0.006,
    // the bias allowed.
    const StrandModel model = tuft();
    const auto settings = with_voxel_size(0.02, 256);
    const StrandGeometry upright = model.geometry();
    const auto a = bake(upright, settings);
    const double error = rmse_of(upright, a);
    for (const auto& turn : {rotation({1, 0, 0}, 0.5), rotation({0.3, 1, -2}, 1.0), rotation({1, 1, 0}, 2.5)}) {
        const StrandGeometry turned = model.geometry(turn);
        const auto b = bake(turned, settings);
        const Difference d = difference(b, a);
        EXPECT_LT(d.rms, 1.1 * (error + rmse_of(turned, b)));
        EXPECT_LT(std::abs(d.mean), 0.006);
    }
}

TEST(Transmittance, IsTheSameTurnedByARightAngleButForTheDirections) {
    // The grid turns with the model (its extents are the strands'), so that only the 1,024 Fibonacci directions differ.
    // What these are off is measured against 4,096; twice that, 2.5 times with the larger set's own error.
    const StrandModel model = tuft();
    const auto settings = with_voxel_size(0.02, 1024);
    const StrandGeometry upright = model.geometry();
    const auto a = bake(upright, settings);
    const double of_directions = difference(a, bake(upright, with_voxel_size(0.02, 4096))).rms;
    const Difference d =
        difference(bake(model.geometry([](const Vec3d& p) { return Vec3d(p.z, p.x, p.y); }), settings), a);
    EXPECT_LT(d.rms, 2.5 * of_directions);
    EXPECT_LT(std::abs(d.mean), 0.001);
}

/// Whether point v lies within half a width of the axis of a segment that is not its own.
bool is_inside_another(const StrandGeometry& strands, std::size_t v) {
    const Vec3d p(strands.positions[v]);
    for (std::size_t s = 0; s + 1 < strands.vertex_count(); ++s) {
        if (s == v || s + 1 == v || strands.segments[s] != Segment::solid) continue;
        const Vec3d a(strands.positions[s]), along = Vec3d(strands.positions[s + 1]) - a;
        const double t = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
        if (length(p - (a + along * t)) <= 0.5 * double(strands.widths[s])) return true;
    }
    return false;
}

TEST(Transmittance, TakesOpacityAsOpacity) {
    // Extinction is opacity * width: a strand of opacity o and width w is one of opacity 1 and width o w, in the grid
    // exactly, and in the near field but for points inside another strand, which never looks nearer than half of the
    // true width. -ln(1 - o) would make o = 0.9 a strand of 2.3 widths. The widths' products are rounded: 1e-7, and a
    // half float may round the other way: 2^-11 of a voxel's depth.
    const StrandGeometry strands = tuft().geometry();
    std::vector<std::size_t> outside;
    for (std::size_t v = 0; v < strands.vertex_count(); v += 3)
        if (!is_inside_another(strands, v)) outside.push_back(v);
    EXPECT_GT(outside.size(), strands.vertex_count() / 4);
    const auto at_outside = [&](const std::vector<float>& a) {
        std::vector<float> values;
        for (const std::size_t v : outside) values.push_back(a[v]);
        return values;
    };
    for (const double opacity : {0.1, 0.5, 0.9}) {
        const auto clear = bake(tuft(opacity).geometry(), with_voxel_size(0.02));
        const auto thin = bake(tuft().geometry([](const Vec3d& p) { return p; }, opacity), with_voxel_size(0.02));
        const Difference d = difference(at_outside(clear), at_outside(thin));
        EXPECT_LT(d.worst, 2e-3);
        EXPECT_LT(d.rms, 1e-4);
    }
}

TEST(Transmittance, AtASharedRootIsNoDarkerThanRaysThroughEveryStrand) {
    // Ten strands of opacity o from one point. No ray loses more than 1 - o to each, so A >= (1 - o)^10 there; looked
    // at from half of o w instead of half of w, each would take the same e^-0.16 whatever its opacity, all 80 %.
    for (const double opacity : {0.01, 0.05, 0.2}) {
        Random random(44);
        StrandModel model;
        for (int s = 0; s < 10; ++s) {
            const Vec3d direction = random_direction(random);
            std::vector<Vec3d> points;
            for (int k = 0; k < 12; ++k) points.push_back(direction * (0.1 * k));
            model.add(points, 0.006, opacity);
        }
        const auto a = bake(model.geometry(), with_voxel_size(0.02));
        for (std::size_t v = 0; v < a.size(); v += 12) EXPECT_GE(a[v], std::pow(1 - opacity, 10)) << opacity;
    }
}

TEST(Transmittance, OfClearStrandsIsOne) {
    for (const float a : bake(tuft(0).geometry(), with_voxels(64))) EXPECT_NEAR(a, 1, 1e-6);
}

TEST(Transmittance, IsRaisedNowhereByOneMoreStrand) {
    // The same grid with a strand more. Rays lose at least what it covers in the grid; the near-field correction may
    // give back its own voxel's window, (1/4 pi) 2.07 w/h of opacity = 0.165 w/h, where the strand is in the voxel but
    // beyond the window; every neighbouring voxel it passes less than 0.0085 w/h, a straight strand at most 6 of them:
    // 0.22 w/h of A in all.
    const double w = 0.006, size = 0.02;
    const StrandModel before = tuft();
    const auto settings = with_voxel_size(size);
    const auto a = bake(before.geometry(), settings);
    Random random(42);
    for (int k = 0; k < 8; ++k) {
        StrandModel after = before;
        const Vec3d p = random_point_in_ball(random, 0.3) + Vec3d(0, 0.4, 0), d = random_direction(random) * 0.3;
        after.add(straight(p - d, p + d, 12), w);
        const auto b = bake(after.geometry(), settings);
        for (std::size_t v = 0; v < a.size(); ++v)
            EXPECT_LE(b[v], a[v] * (1 + 0.22 * w / size) + 1e-5) << "vertex " << v;
    }
}

TEST(Transmittance, FallsInTheMeanWithEveryStrand) {
    // A grid of one voxel size, to which ten strands more are added five times.
    StrandModel model = tuft();
    Random random(43);
    const auto mean = [&] {
        const auto a = bake(model.geometry(), with_voxel_size(0.02));
        return std::accumulate(a.begin(), a.begin() + 10'000, 0.0) / 10'000;
    };
    double last = mean();
    for (int k = 0; k < 5; ++k) {
        for (int s = 0; s < 10; ++s) {
            const Vec3d p = random_point_in_ball(random, 0.3) + Vec3d(0, 0.4, 0), d = random_direction(random) * 0.3;
            model.add(straight(p - d, p + d, 12), 0.006);
        }
        const double now = mean();
        EXPECT_LT(now, last);
        last = now;
    }
}

TEST(Transmittance, ConvergesInDirections) {
    // The grid is the same, so 4,096 directions are the truth of the sum. A kinked function on the sphere:
    // Fibonacci N^-3/4, random N^-1/2 sigma(T), sigma below 1/2.
    const StrandGeometry strands = tuft().geometry();
    TransmittanceSettings settings = with_voxels(48, 4096);
    const auto truth = bake(strands, settings);
    const auto rms = [&](DirectionSet set, int directions) {
        settings.direction_set = set;
        settings.directions = directions;
        return difference(bake(strands, settings), truth).rms;
    };
    const double r9 = rms(DirectionSet::fibonacci, 9), r32 = rms(DirectionSet::fibonacci, 32);
    const double r100 = rms(DirectionSet::fibonacci, 100), r400 = rms(DirectionSet::fibonacci, 400);
    const double random = rms(DirectionSet::random, 100), stratified = rms(DirectionSet::stratified, 100);
    // Each step is 3 to 4 times as many directions: at least N^-1/2, that of chance.
    EXPECT_LT(r32, r9 * std::sqrt(9 / 32.0));
    EXPECT_LT(r100, r32 * std::sqrt(32 / 100.0));
    EXPECT_LT(r400, r100 * std::sqrt(100 / 400.0));
    EXPECT_LT(random, 0.5 / std::sqrt(100.0));
    EXPECT_LT(r32, random);       // 32 of them are better than 100 random ones
    EXPECT_LT(r100, random / 2);  // N^-3/4 would be a third, but this tuft is grained: w/h = 0.17
    EXPECT_LT(stratified, random);
}

TEST(Transmittance, DependsOnTheSeedOfASeededSetOnly) {
    const StrandGeometry strands = tuft().geometry();
    TransmittanceSettings one = with_voxels(40, 25), two = one;
    two.seed = 2;
    EXPECT_EQ(bake(strands, one), bake(strands, two));
    one.direction_set = two.direction_set = DirectionSet::stratified;
    EXPECT_NE(bake(strands, one), bake(strands, two));
}

TEST(Transmittance, StopsWhenItIsCancelled) {
    /// Cancels itself when the stage has come so far.
    struct CancelsAt : Progress {
        double at;
        explicit CancelsAt(double fraction) : at(fraction) {}
        void report(double fraction) override {
            EXPECT_LE(fraction, 1);
            if (fraction >= at) cancel();
        }
    };
    const StrandGeometry strands = tuft().geometry();
    for (const double at : {0.0, 0.2, 0.3, 0.5}) {
        CancelsAt progress(at);
        if (at == 0) progress.cancel();
        try {
            bake_transmittance_volume({strands}, with_voxels(64), progress);
            ADD_FAILURE() << "went on at " << at;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::cancelled);
        }
    }
}

TEST(Transmittance, TellsWhatItUsed) {
    Progress progress;
    const StrandGeometry strands = tuft().geometry();
    TransmittanceScene scene{strands};
    EXPECT_EQ(bake_transmittance_volume(scene, with_voxels(64, 36), progress).density, nullptr);
    scene.keep_density = true;
    const Transmittance baked = bake_transmittance_volume(scene, with_voxels(64, 36), progress);
    EXPECT_EQ(baked.directions, 36);
    EXPECT_EQ(baked.average.size(), 10'000u);
    ASSERT_TRUE(baked.density);
    EXPECT_EQ(baked.occupied_voxels, baked.density->occupied_voxels());
    EXPECT_GT(baked.occupied_voxels, 1000u);
}

}  // namespace
}  // namespace hairbake
