// Harmonics and bent cones of the volume method.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/gauss_legendre.h"
#include "core/base/parallel.h"
#include "core/base/spherical_harmonics.h"
#include "core/environment/sh_rotation.h"
#include "core/visibility/direction_moments.h"
#include "core/visibility/direction_set.h"
#include "tests/core/volume/volume_steps.h"
#include "tests/support/analytic_media.h"
#include "tests/support/random_media.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;
using std::numbers::pi;

Transmittance bake_all(const StrandGeometry& strands, TransmittanceSettings settings, int bands, bool cone = true) {
    settings.sh_bands = bands;
    settings.bent_cone = cone;
    Progress progress;
    return bake_transmittance_volume({strands}, settings, progress);
}

/// A ball of wavy strands, 6,000 vertices, denser on the side of +x.
StrandModel lopsided_ball() {
    Random random(31);
    StrandModel model;
    for (int s = 0; s < 300; ++s) {
        std::vector<Vec3d> points{random_point_in_ball(random, 0.6) + Vec3d(s % 2 ? 0.5 : 0, 0, 0)};
        Vec3d direction = random_direction(random);
        for (int k = 0; k < 19; ++k) {
            direction = normalized(direction + random_direction(random) * 0.3);
            points.push_back(points.back() + direction * 0.05);
        }
        model.add(points, 0.008, random.next(0.3, 1));
    }
    return model;
}

TEST(Directional, AIsTheZerothCoefficientAndDoesNotDependOnWhatElseIsAsked) {
    const StrandGeometry strands = lopsided_ball().geometry();
    const auto alone = bake(strands, with_voxels(48));
    for (int bands = 0; bands <= 4; ++bands)
        for (const bool cone : {false, true}) {
            const Transmittance baked = bake_all(strands, with_voxels(48), bands, cone);
            EXPECT_EQ(baked.average, alone);
            ASSERT_EQ(baked.sh.size(), alone.size() * std::size_t(bands * bands));
            ASSERT_EQ(baked.bent_cone.size(), cone ? 4 * alone.size() : 0);
            // Two roundings of a float of at most 4.
            for (std::size_t v = 0; bands > 0 && v < alone.size(); ++v)
                ASSERT_NEAR(baked.sh[v * std::size_t(bands * bands)] / (2 * std::sqrt(pi)), alone[v], 3e-7);
        }
}

TEST(Directional, CoefficientsAreTheDefinitionOnTheSweepOfEveryDirection) {
    // T_k of the sweep alone, one direction at a time; then the factor of the near-field correction. The fixed point
    // rounds a sum of four directions by 2^-25 of its range: 40 directions, 4 pi: 1e-6; and floats.
    const StrandGeometry strands = lopsided_ball().geometry();
    const HairVolume volume = volume_of(strands, with_voxels(48));
    const auto directions = make_directions(DirectionSet::fibonacci, 40, 0);
    DirectionalSums sums(strands.vertex_count(), directions, 4, true);
    for (std::size_t k = 0; k < directions.size(); ++k) {
        const auto t = sweep_one(volume, directions[k]);
        for (std::size_t v = 0; v < t.size(); ++v) sums.add(v, k, double{t[v]});
    }
    const DirectionalMeans swept = sums.means();
    const Transmittance baked = bake_all(strands, with_voxels(48, 40), 4);
    for (std::size_t v = 0; v < strands.vertex_count(); ++v) {
        const double factor = double(baked.average[v]) / double(swept.average[v]);
        for (std::size_t i = 0; i < 16; ++i)
            ASSERT_NEAR(baked.sh[16 * v + i], factor * double(swept.sh[16 * v + i]), 1e-5) << v << " " << i;
        for (std::size_t i = 0; i < 3; ++i) ASSERT_NEAR(baked.bent_cone[4 * v + i], swept.bent_cone[4 * v + i], 1e-4);
        ASSERT_NEAR(baked.bent_cone[4 * v + 3], swept.bent_cone[4 * v + 3], 1e-3);
    }
}

/// Zonal coefficients of a ball's transmittance at distance r of its centre: c_lm = lambda_l Y_lm(outward), lambda_l =
/// 2 pi int T(mu) P_l(mu) dmu, T = exp(-extinction * way out).
std::array<double, 4> ball_lambda(double extinction, double r) {
    std::array<double, 4> lambda{};
    const Quadrature rule = gauss_legendre(200);
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double mu = rule.nodes[k], way = std::sqrt(1 - r * r * (1 - mu * mu)) - r * mu;
        const double p[] = {1, mu, 1.5 * mu * mu - 0.5, 2.5 * mu * mu * mu - 1.5 * mu};
        for (std::size_t l = 0; l < 4; ++l) lambda[l] += 2 * pi * rule.weights[k] * std::exp(-extinction * way) * p[l];
    }
    return lambda;
}

TEST(Directional, OfABallOfIsotropicFibresIsZonal) {
    // Mean over 200 probes at distance r, each turned into its own frame, and over four balls: at the centre all but
    // c_0 vanish. The scatter of the balls' means is below 0.02; half a voxel of smearing at 64 voxels changes lambda_1
    // near the surface by a percent; 100 directions err by 0.01 in coefficients of order 1.
    for (const double extinction : {0.5, 2.0})
        for (const double r : {0.0, 0.6, 0.97}) {
            std::array<double, 4> mean{};
            for (int seed = 1; seed <= 4; ++seed) {
                Random random(static_cast<std::uint64_t>(seed));
                const Medium medium = ball_medium(random, {.width = 0.001, .length = 0.2, .extinction = extinction}, r,
                                                  200, Truth::mean_field);
                const StrandGeometry strands = medium.model.geometry();
                const Transmittance baked = bake_all(strands, with_voxels(64), 4, false);
                std::vector<double> y(16);
                for (std::uint32_t v = medium.first_probe; v < strands.vertex_count(); ++v) {
                    const Vec3d p(strands.positions[v]);
                    ShBasis(4).evaluate(r > 0 ? normalized(p) : Vec3d(0, 1, 0), y);
                    // sum over m of Y_lm^2 = (2 l + 1) / (4 pi)
                    for (std::size_t l = 0; l < 4; ++l)
                        for (std::size_t i = l * l; i < (l + 1) * (l + 1); ++i)
                            mean[l] += double(baked.sh[16 * std::size_t{v} + i]) * y[i] * 4 * pi / double(2 * l + 1) /
                                       (4.0 * 200);
                }
            }
            const auto lambda = ball_lambda(extinction, r);
            for (std::size_t l = 0; l < 4; ++l)
                EXPECT_NEAR(mean[l], lambda[l], 0.06) << "extinction " << extinction << " r " << r << " band " << l;
        }
}

TEST(Directional, OverAnOpaqueHalfSpaceIsHalfTheSky) {
    // Half a voxel above a slab, 40 x 40 x 4 voxels, that lets nothing through: A = 1/2, c_1 = sqrt(3 pi) / 2 along the
    // normal, a cone of 90 degrees, even bands 0. The slab ends 20 voxels away: its edge lies up to 1.5 / 20 below the
    // horizon, which adds 0.04 to A at most, and a probe stands in the voxels above the strands' own.
    Random random(9);
    StrandModel model;
    for (int k = 0; k < 60000; ++k) {
        const Vec3d p = random_point_in_box(random, {-20, -20, -4}, {20, 20, 0});
        const Vec3d d = random_direction(random) * 0.5;
        model.add(straight(p - d, p + d), 0.2);
    }
    const auto probe = model.add_probes({{0.3, 0.2, 1.5}});
    const Transmittance baked = bake_all(model.geometry(), with_voxel_size(1, 1024), 4);
    const float* c = &baked.sh[16 * std::size_t{probe}];
    const float* cone = &baked.bent_cone[4 * std::size_t{probe}];
    EXPECT_NEAR(baked.average[probe], 0.5, 0.05);
    EXPECT_NEAR(c[2], std::sqrt(3 * pi) / 2, 0.08);
    EXPECT_NEAR(c[1], 0, 0.05);
    EXPECT_NEAR(c[3], 0, 0.05);
    for (int i = 4; i < 9; ++i) EXPECT_NEAR(c[i], 0, 0.2) << i;
    EXPECT_NEAR(cone[2], 1, 0.01);
    EXPECT_NEAR(cone[3], pi / 2, 0.12);
}

TEST(Directional, ALoneStrandSeesTheWholeSky) {
    // A = 1 where nothing is: probes alone.
    StrandModel model;
    model.add_probes({{0, 0, 0}, {1, 0, 0}, {0.2, 0.7, 0.1}});
    const Transmittance baked = bake_all(model.geometry(), with_voxels(32), 2);
    for (std::size_t v = 0; v < 3; ++v) {
        EXPECT_EQ(std::vector(&baked.bent_cone[4 * v], &baked.bent_cone[4 * v] + 4),
                  (std::vector<float>{0, 0, 0, std::numbers::pi_v<float>}));
        EXPECT_NEAR(baked.sh[4 * v], 2 * std::sqrt(pi), 1e-5);
        for (std::size_t i = 1; i < 4; ++i) EXPECT_NEAR(baked.sh[4 * v + i], 0, 0.02);
    }
}

TEST(Directional, TurnsWithTheModel) {
    // Turned model, turned coefficients. Voxels and directions lie otherwise then, so both bakes err independently. The
    // volume method errs by up to 0.016 in A (RMS, docs/accuracy.md, section 2; these strands are as wide as its
    // widest, w/h = 0.27). So the two differ by up to 0.023, which is 0.08 in c_0 = 2 sqrt(pi) A. In no other
    // coefficient is it more: an error of T at single directions is spread evenly over all coefficients, one common to
    // all is in c_0 alone. A turn the wrong way would differ by sqrt(2) times the coefficients' size.
    const StrandModel model = lopsided_ball();
    const Matrix3 turn = rotation_matrix({25, 140, -70});
    const StrandGeometry straight_up = model.geometry(),
                         turned = model.geometry([&](const Vec3d&p) { return transform(turn, p); });
    const Transmittance a = bake_all(straight_up, with_voxels(64, 400), 3),
                        b = bake_all(turned, with_voxels(64, 400), 3);
    std::array<double, 9> square{};
    double size = 0, norm = 0;
    for (std::size_t v = 0; v < straight_up.vertex_count(); v += 5) {
        std::vector<Vec3d> c(9);
        for (std::size_t i = 0; i < 9; ++i) c[i] = Vec3d(a.sh[9 * v + i], 0, 0);
        const auto expected = rotate_sh(c, 3, turn);
        double norm_a = 0, norm_b = 0;
        for (std::size_t i = 0; i < 9; ++i) square[i] += std::pow(double(b.sh[9 * v + i]) - expected[i].x, 2);
        for (std::size_t i = 1; i < 4; ++i) {
            norm_a += std::pow(double(a.sh[9 * v + i]), 2);
            norm_b += std::pow(double(b.sh[9 * v + i]), 2);
        }
        size += norm_a / 3;
        norm += std::pow(std::sqrt(norm_a) - std::sqrt(norm_b), 2);
    }
    const double count = double(straight_up.vertex_count()) / 5;
    EXPECT_GT(std::sqrt(size / count), 3 * 0.08) << "the test is too weak";
    for (std::size_t i = 0; i < 9; ++i) EXPECT_LT(std::sqrt(square[i] / count), 0.08) << i;
    EXPECT_LT(std::sqrt(norm / count), 0.08);  // the length of band 1 does not change
}

TEST(Directional, GivesTheSameBitsForAnyNumberOfThreads) {
    const StrandGeometry strands = lopsided_ball().geometry();
    Transmittance one;
    with_threads(1, [&] { one = bake_all(strands, with_voxels(48), 4); });
    for (const int threads : {2, 7})
        with_threads(threads, [&] {
            const Transmittance many = bake_all(strands, with_voxels(48), 4);
            EXPECT_EQ(many.sh, one.sh);
            EXPECT_EQ(many.bent_cone, one.bent_cone);
        });
}

}  // namespace
}  // namespace hairbake
