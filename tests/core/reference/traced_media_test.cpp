// The tracer against closed forms: media of random fibres whose mean transmittance is known.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/visibility/direction_set.h"
#include "tests/core/reference/trace.h"
#include "tests/support/analytic_media.h"
#include "tests/support/random_media.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

std::vector<float> trace_probes(const Medium& medium) {
    std::vector<std::uint32_t> probes(medium.expected.size());
    std::iota(probes.begin(), probes.end(), medium.first_probe);
    return trace(medium.model.geometry(), probes, make_directions(DirectionSet::fibonacci, 256, 0));
}

/// Tolerance: four standard errors of the realisations' mean; 0.001 for the 256 Fibonacci directions (for one probe the
/// kink at the horizon costs about 0.4 N^-3/4 = 0.006; the probes' places average it) and for the fixed number of
/// fibres instead of a Poisson one; `more` for what the test says.
void expect_transmittance(const std::function<Medium(Random&)>& make, int realisations, double more = 0) {
    const MeanError error = mean_error(realisations, make, trace_probes);
    EXPECT_LT(error.standard_error, 0.007) << "the test is too weak";
    EXPECT_NEAR(error.mean, 0, 4 * error.standard_error + 0.001 + more);
}

Fibres fibres(double extinction, double width, double length, double opacity = 1) {
    Fibres f;
    f.extinction = extinction;
    f.width = width;
    f.length = length;
    f.opacity = opacity;
    return f;
}

TEST(TracedMedium, BallOfIsotropicFibres) {
    for (const double r : {0.0, 0.5, 0.97})
        for (const double extinction : {0.5, 2.0})
            expect_transmittance(
                [&](Random& random) {
                    return ball_medium(random, fibres(extinction, 0.005, 0.3), r, r == 0 ? 1 : 40, Truth::fibres);
                },
                r == 0 ? 60 : 10);
}

TEST(TracedMedium, BallOfTranslucentFibres) {
    // E[(1 - o)^n] = exp(-o mean n) for a Poisson number n of crossings: opacity enters as opacity, not as
    // -ln(1 - opacity), which would give 0.304 instead of 0.418 at half the radius here.
    Fibres f = fibres(1, 0.005, 0.3, 0.6);
    const auto make = [&](Random& random) {
        Medium medium = ball_medium(random, f, 0.5, 40, Truth::mean_field);
        // Round ends add w/L to the projection; a probe inside a fibre (optical depth sigma w / opacity) sees it as one
        // more crossing.
        const double length = 0.3 / (1 + 0.3 * 0.75);
        const double a = std::exp(-0.005) * ball_transmittance(1 + 0.005 / length, 1, 0.5);
        medium.expected.assign(medium.expected.size(), a);
        return medium;
    };
    expect_transmittance(make, 10);
}

TEST(TracedMedium, HalfSpaceOfIsotropicFibres) {
    // A(z) = 1/2 E2(z): depth 0.3 and 1 below the face of a slab of 5, 10 wide. What comes through the far face is at
    // most 1/2 E2(4) = 0.0016 and part of the expected value. Through the sides come rays of more than 4, which in the
    // half-space rise by less than a quarter: at most 1/8 of the directions, times e^-4: 0.0023.
    for (const double z : {0.3, 1.0})
        expect_transmittance(
            [&](Random& random) { return slab_medium(random, fibres(1, 0.03, 0.5), 5, 10, z, 80, Truth::fibres); }, 6,
            0.0023);
}

TEST(TracedMedium, SlabOfIsotropicFibres) {
    // Through the sides, 4 away, as above: 0.0023. At the face the fibres' thickness blurs the slab by up to w/2:
    // sigma w/2 of the directions that run into the slab, and a probe is inside a fibre half as often as deep down:
    // 0.005.
    for (const double z : {0.0, 0.5})
        expect_transmittance(
            [&](Random& random) { return slab_medium(random, fibres(1, 0.01, 0.3), 1, 10, z, 80, Truth::fibres); }, 6,
            0.0023 + (z == 0 ? 0.005 : 0));
}

TEST(TracedMedium, BallOfParallelFibres) {
    // The quadrature that gives the expected values agrees with the closed form at the centre (0.433 for a depth of 1).
    Random unused(1);
    Fibres f = fibres(1, 0.005, 0.4);
    f.parallel_to_z = true;
    EXPECT_NEAR(parallel_ball_medium(unused, f, 0, 1, Truth::mean_field).expected[0], parallel_ball_centre(1), 1e-4);
    // Round ends: the projection of a capsule is w L sin(theta) + pi w^2 / 4, so that each direction's optical depth
    // grows by pi/4 w / L_cut, 1.2 %: 0.0045 of A = 0.43 too dark, put into the expectation.
    for (const double r : {0.0, 0.5})
        expect_transmittance(
            [&](Random& random) {
                Medium medium = parallel_ball_medium(random, f, r, r == 0 ? 1 : 40, Truth::fibres);
                const double ends = std::numbers::pi / 4 * 0.005 / (0.4 / (1 + 0.4 * 0.75));
                for (double& a : medium.expected) a += a * std::log(a) * ends;
                return medium;
            },
            r == 0 ? 40 : 10);
}

}  // namespace
}  // namespace hairbake
