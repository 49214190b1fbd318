#include "core/irradiance/kernel_sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "tests/support/make_map.h"

namespace hairbake {
namespace {

using std::numbers::pi;

TEST(AngleGrid, NodesRunFromPiToZeroInNearlyEvenSteps) {
    const AngleGrid grid(64);
    EXPECT_DOUBLE_EQ(grid.theta(0), pi);
    EXPECT_DOUBLE_EQ(grid.theta(32), pi / 2);
    EXPECT_EQ(grid.theta(64), 0);
    for (int node = 0; node < 64; ++node) {
        const double step = grid.theta(node) - grid.theta(node + 1);
        EXPECT_LE(step, grid.largest_step());
        EXPECT_GE(step, grid.largest_step() / 1.5);  // the smallest is sqrt 2 below the largest
    }
}

TEST(KernelSum, ItIsTheSumOverTheLights) {
    Progress progress;
    const LightSet lights = make_light_set(testing::noise_map(64, 1), 64, progress);
    KernelTable table(AngleGrid(1024));
    table.add_row([](double theta) { return std::sin(theta); });
    table.add_row([](double) { return 1; });
    table.add_row([](double theta) { return std::pow(std::max(0.0, std::cos(theta - 1)), 64.0); });
    Random random(2);
    std::vector<Vec3d> tangents;
    for (int k = 0; k < 20; ++k) tangents.push_back(testing::random_direction(random));
    const std::vector<Vec3f> sums = sum_kernels(lights, tangents, table, progress);
    for (std::size_t k = 0; k < tangents.size(); ++k) {
        Vec3d expected[3];
        for (std::size_t i = 0; i < lights.size(); ++i) {
            const double c = dot(tangents[k], Vec3d{lights.x[i], lights.y[i], lights.z[i]});
            const double theta = std::acos(std::clamp(c, -1.0, 1.0));
            const Vec3d flux{lights.flux[4 * i], lights.flux[4 * i + 1], lights.flux[4 * i + 2]};
            expected[0] += flux * std::sin(theta);
            expected[1] += flux;
            expected[2] += flux * std::pow(std::max(0.0, std::cos(theta - 1)), 64.0);
        }
        // Linear interpolation: step^2 / 8 * second derivative = (4 / 1024)^2 / 8 * 64 = 1.2e-4 of a light's flux at
        // the lobe's peak, a fifth of that on average over the lobe; sine and constant 2e-6. Single precision adds
        // 1e-5.
        const double tolerances[] = {2e-5, 1e-5, 1.2e-4};
        for (int row = 0; row < 3; ++row)
            EXPECT_LT(length(Vec3d(sums[3 * k + row]) - expected[row]), tolerances[row] * length(expected[row])) << row;
    }
}

TEST(KernelSum, ThreadsDoNotChangeABit) {
    Progress progress;
    const LightSet lights = make_light_set(testing::noise_map(64, 3), 64, progress);
    KernelTable table(AngleGrid(256));
    table.add_row([](double theta) { return std::sin(theta); });
    std::vector<Vec3d> tangents;
    Random random(4);
    for (int k = 0; k < 100; ++k) tangents.push_back(testing::random_direction(random));
    std::vector<Vec3f> sums[3];
    const int threads[] = {1, 2, 7};
    for (int k = 0; k < 3; ++k)
        with_threads(threads[k], [&] { sums[k] = sum_kernels(lights, tangents, table, progress); });
    EXPECT_EQ(sums[0], sums[1]);
    EXPECT_EQ(sums[0], sums[2]);
}

}  // namespace
}  // namespace hairbake
