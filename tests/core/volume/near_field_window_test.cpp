#include "core/volume/near_field_window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/gauss_legendre.h"
#include "core/volume/neighborhood.h"

namespace hairbake {
namespace {

/// Integral over |z| < r of q(|z|) / z^2 times the probability that x + z, x uniform in the unit voxel, lies in the
/// voxel `axes` steps away (on different axes): along an axis without step 1 - |z_i|, with one max(0, z_i), as r < 1.
/// By Gauss-Legendre in the radius and, octant by octant, in the two angles.
double weight_by_quadrature(int axes) {
    const double r = double(NearFieldWindow::radius);
    const Quadrature rule = gauss_legendre(40);
    const auto at = [&](std::size_t k, double length) { return length / 2 * (rule.nodes[k] + 1); };
    double sum = 0;
    for (std::size_t i = 0; i < 40; ++i)
        for (std::size_t j = 0; j < 40; ++j)
            for (std::size_t k = 0; k < 40; ++k) {
                const double d = at(i, r), theta = at(j, std::numbers::pi / 2), phi = at(k, std::numbers::pi / 2);
                const double sine = std::sin(theta);
                const double z[3] = {d * sine * std::cos(phi), d * sine * std::sin(phi), d * std::cos(theta)};
                double probability = 1;
                for (int axis = 0; axis < 3; ++axis) probability *= axis < axes ? z[axis] : 1 - z[axis];
                const double q = std::pow(1 - d * d / (r * r), 2);
                const double angles = rule.weights[j] * rule.weights[k] * std::pow(std::numbers::pi / 4, 2) * sine;
                sum += rule.weights[i] * r / 2 * angles * q * probability;
            }
    return sum * (8 >> axes);  // octants that reach that voxel
}

TEST(NearFieldWindow, WeightsAreTheMeanIntegralsOverTheVoxelsAround) {
    const NearFieldWindow window;
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            for (int k = -1; k <= 1; ++k) {
                const auto o = static_cast<std::size_t>(9 * (i + 1) + 3 * (j + 1) + (k + 1));
                const int axes = std::abs(i) + std::abs(j) + std::abs(k);
                const double mean_sine = axes == 0 ? std::numbers::pi / 4 : 1;  // the own voxel is in no direction
                EXPECT_NEAR(window.weight[o], weight_by_quadrature(axes) * mean_sine, 2e-7)
                    << axes;  // constants of 7 digits
            }
}

TEST(NearFieldWindow, WeightsAddUpToTheWholeWindow) {
    // int_0^r 4 pi (1 - d^2/r^2)^2 dd = 4 pi r 8/15, when the own voxel's mean sine is taken out again.
    const NearFieldWindow window;
    const double total = std::accumulate(window.weight.begin(), window.weight.end(), 0.0);
    const double own = double(window.weight[13]);
    EXPECT_NEAR(total - own + own * 4 / std::numbers::pi,
                4 * std::numbers::pi * double(NearFieldWindow::radius) * 8 / 15, 2e-6);
}

TEST(NearFieldWindow, DirectionsAndStepsPointToTheVoxelsAround) {
    const NearFieldWindow window;
    for (std::size_t o = 0; o < NearFieldWindow::padded; ++o) {
        const double norm = std::hypot(window.direction_x[o], window.direction_y[o], window.direction_z[o]);
        if (o >= NearFieldWindow::offsets) {
            EXPECT_EQ(window.weight[o], 0);
            EXPECT_EQ(window.step[o], 0);
        } else if (o == 13) {
            EXPECT_EQ(norm, 0);
            EXPECT_EQ(window.step[o], 0);
        } else {
            const int n = static_cast<int>(o), i = n / 9 - 1, j = n / 3 % 3 - 1, k = n % 3 - 1;
            const double length = std::sqrt(double(i * i + j * j + k * k));
            EXPECT_NEAR(norm, 1, 1e-6);
            EXPECT_NEAR(window.direction_x[o], i / length, 1e-6);
            EXPECT_NEAR(window.direction_y[o], j / length, 1e-6);
            EXPECT_NEAR(window.direction_z[o], k / length, 1e-6);
            EXPECT_EQ(window.step[o], 100 * i + 10 * j + k);
        }
    }
}

}  // namespace
}  // namespace hairbake
