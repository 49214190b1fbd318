#include "core/visibility/direction_moments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/base/spherical_harmonics.h"
#include "core/visibility/direction_set.h"
#include "core/visibility/hemisphere_means.h"

namespace hairbake {
namespace {

using std::numbers::pi;

/// The answers of one point that sees `t` of the light of each direction.
DirectionalMeans answers(const std::vector<Vec3d>& directions, const std::function<double(const Vec3d&)>& t, int bands,
                         bool cone) {
    DirectionalSums sums(1, directions, bands, cone);
    for (std::size_t k = 0; k < directions.size(); ++k) sums.add(0, k, t(directions[k]));
    return sums.means();
}

/// 4,096 Fibonacci directions: a cap's share of them is right to about 1 / 4096 times the number of points along its
/// rim, 200, to the power of 1/2: 0.0035.
std::vector<Vec3d> many() { return make_directions(DirectionSet::fibonacci, 4096, 0); }

TEST(DirectionMoments, KeepsWhatTheAnswersNeed) {
    const std::vector<Vec3d> directions{normalized(Vec3d(0.3, -0.5, 0.7))};
    std::vector<double> y(16);
    ShBasis(4).evaluate(directions[0], y);
    for (const auto& [bands, cone, count] : {std::tuple(0, false, 1),
                                             {1, false, 1},
                                             {0, true, 4},
                                             {1, true, 4},
                                             {2, false, 4},
                                             {3, true, 9},
                                             {4, false, 16}}) {
        const DirectionMoments moments(directions, bands, cone);
        ASSERT_EQ(moments.count(), std::size_t(count));
        const auto w = moments.weights(0);
        EXPECT_EQ(w[0], 1);
        if (count < 4) continue;
        EXPECT_EQ(Vec3d(w[1], w[2], w[3]), directions[0]);
        for (std::size_t i = 4; i < w.size(); ++i) EXPECT_EQ(w[i], y[i]);
    }
}

TEST(DirectionMoments, HarmonicsAreTheirDefinitionForAnyT) {
    // c_i = (4 pi / N) sum of T_k Y_i(w_k) (docs/math.md, section 12); floats of at most 4: 1e-6.
    const auto directions = make_directions(DirectionSet::random, 60, 5);
    const auto t = [](const Vec3d& w) { return 0.3 + 0.2 * w.x - 0.1 * w.y * w.z + (w.z > 0.2 ? 0.25 : 0); };
    for (int bands = 1; bands <= 4; ++bands) {
        const auto sh = answers(directions, t, bands, false).sh;
        ASSERT_EQ(sh.size(), std::size_t(bands * bands));
        std::vector<double> y(sh.size()), expected(sh.size());
        for (const Vec3d& w : directions) {
            ShBasis(bands).evaluate(w, y);
            for (std::size_t i = 0; i < y.size(); ++i) expected[i] += 4 * pi / 60 * t(w) * y[i];
        }
        for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(sh[i], expected[i], 1e-6) << i;
    }
}

TEST(DirectionMoments, AnOpenSkyIsItsMeanAndAConeOfAllDirections) {
    const auto open = answers(
        many(), [](const Vec3d&) { return 1; }, 4, true);
    EXPECT_EQ(open.average[0], 1);
    EXPECT_NEAR(open.sh[0], 2 * std::sqrt(pi), 1e-6);
    for (std::size_t i = 1; i < 16; ++i) EXPECT_NEAR(open.sh[i], 0, 0.01);
    EXPECT_EQ(open.bent_cone, (std::vector<float>{0, 0, 0, std::numbers::pi_v<float>}));
    const auto dark = answers(
        many(), [](const Vec3d&) { return 0; }, 4, true);
    EXPECT_EQ(dark.bent_cone, std::vector<float>(4, 0));
    EXPECT_EQ(dark.sh, std::vector<float>(16, 0));
}

TEST(DirectionMoments, OfAnOpaqueHalfSpaceAreKnown) {
    // Funk-Hecke: c_lm = 2 pi int_0^1 P_l dx Y_lm(n): 1, 1/2, 0, -1/8. |b| = 1/2, so 2 |b| - 1 = 0: 90 degrees. c: four
    // pi times 0.0035 times |Y| <= 0.75.
    const Vec3d n = normalized(Vec3d(0.2, 0.7, -0.4));
    const auto half = answers(
        many(), [&](const Vec3d& w) { return dot(w, n) > 0 ? 1 : 0; }, 4, true);
    std::vector<double> y(16);
    ShBasis(4).evaluate(n, y);
    const double lambda[] = {2 * pi, pi, 0, -pi / 4};
    for (int l = 0; l < 4; ++l)
        for (int i = l * l; i < (l + 1) * (l + 1); ++i) EXPECT_NEAR(half.sh[i], lambda[l] * y[i], 0.033) << i;
    EXPECT_NEAR(half.average[0], 0.5, 0.0035);
    const Vec3d axis(half.bent_cone[0], half.bent_cone[1], half.bent_cone[2]);
    EXPECT_NEAR(length(axis), 1, 1e-6);
    EXPECT_GT(dot(axis, n), 0.9999);
    EXPECT_NEAR(half.bent_cone[3], pi / 2, 0.015);
}

TEST(DirectionMoments, ABentConeOfACapIsTheCap) {
    // |b| = (1 + cos delta) / 2. d delta = 2 d|b| / sin delta: 0.0035 of a share of (1 - cos delta) / 2.
    const Vec3d n = normalized(Vec3d(-0.5, 0.1, 0.6));
    for (const double degrees : {30.0, 60.0, 120.0, 150.0}) {
        const double delta = degrees * pi / 180;
        const auto cap = answers(
            many(), [&](const Vec3d& w) { return dot(w, n) > std::cos(delta) ? 1 : 0; }, 0, true);
        EXPECT_TRUE(cap.sh.empty());
        EXPECT_GT(dot(Vec3d(cap.bent_cone[0], cap.bent_cone[1], cap.bent_cone[2]), n), 0.999);
        EXPECT_NEAR(cap.bent_cone[3], delta, 0.03) << degrees;
    }
}

HemisphereSums over(const std::vector<Vec3d>& directions, const Vec3d& n, const std::function<double(double)>& t) {
    HemisphereSums sums;
    for (const Vec3d& w : directions) sums.add(t(dot(w, n)), dot(w, n));
    return sums;
}

TEST(HemisphereMeans, AreExactlyOneWhereNothingIsBlockedWhateverTheDirections) {
    for (const int count : {2, 9, 100})
        for (const Vec3d& n : {Vec3d(0, 1, 0), normalized(Vec3d(0.3, -0.2, 0.9))}) {
            const auto directions = make_directions(DirectionSet::fibonacci, count, 0);
            EXPECT_EQ(over(directions, n, [](double) { return 1; }).means(), (std::array<float, 2>{1, 1}));
        }
}

TEST(HemisphereMeans, OfTheCosineAreAHalfAndTwoThirds) {
    // int_0^1 mu = 1/2; int mu^2 / int mu = 2/3. The rim has no weight here: 0.0005 for 4,096 directions.
    const auto means = over(many(), normalized(Vec3d(0.1, 0.4, -0.3)), [](double mu) { return mu; }).means();
    EXPECT_NEAR(means[0], 0.5, 0.002);
    EXPECT_NEAR(means[1], 2.0 / 3, 0.002);
}

TEST(HemisphereMeans, CountNothingBelowThePlaneAndAreOneWithoutADirection) {
    HemisphereSums sums;
    sums.add(0, -0.5);
    sums.add(0, 0);
    EXPECT_EQ(sums.means(), (std::array<float, 2>{1, 1}));
    sums.add(0.25, 0.5);
    sums.add(0.75, 0.25);
    EXPECT_EQ(sums.means(), (std::array<float, 2>{0.5f, float(0.3125 / 0.75)}));
}

}  // namespace
}  // namespace hairbake
