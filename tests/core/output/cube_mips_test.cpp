#include "core/output/cube_mips.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/random.h"

namespace hairbake {
namespace {

double mean_over_sphere(const CubeTexels& cube, int n) {
    const std::vector<double> solid_angles = cube_texel_solid_angles(n);
    double sum = 0;
    for (std::size_t i = 0; i < cube.size(); ++i) sum += solid_angles[i % solid_angles.size()] * double(cube[i].x);
    return sum / (4 * std::numbers::pi);
}

TEST(CubeMips, HaveTheSizesOfTheGraphicsInterfacesDownToOne) {
    EXPECT_EQ(mip_level_count(1), 1);
    EXPECT_EQ(mip_level_count(16), 5);
    EXPECT_EQ(mip_level_count(17), 5);
    EXPECT_EQ(mip_level_count(255), 8);
    const auto levels = cube_mips(CubeTexels(6 * 22 * 22), 22);
    ASSERT_EQ(levels.size(), 5u);
    const std::size_t sizes[] = {22, 11, 5, 2, 1};
    for (int k = 0; k < 5; ++k) EXPECT_EQ(levels[k].size(), 6 * sizes[k] * sizes[k]);
}

TEST(CubeMips, OfAConstantMapAreThatConstantToTheLastBit) {
    const Vec3f constant{0.1f, 3e4f, 1e-7f};
    for (const int n : {4, 5, 7, 16, 22, 31, 100})
        for (const CubeTexels& level : cube_mips(CubeTexels(std::size_t(6) * n * n, constant), n))
            for (const Vec3f& texel : level) ASSERT_EQ(texel, constant) << n;
}

TEST(CubeMips, SpreadALoneTexelByItsShareOfTheSolidAngle) {
    // A texel of radiance 1 in a face of 8 has the mean omega_8 / omega_4 in the level of 4 and omega_8 / omega_2 in
    // that of 2. Floats round to 6e-8 of it at each level.
    constexpr int row = 1, column = 6;
    CubeTexels cube(6 * 64);
    cube[cube_texel_index(8, 3, row, column)] = Vec3f(1);
    const auto levels = cube_mips(cube, 8);
    const double own = cube_texel_solid_angles(8)[row * 8 + column];
    EXPECT_NEAR(levels[1][cube_texel_index(4, 3, 0, 3)].x, own / cube_texel_solid_angles(4)[3], 1e-7);
    EXPECT_NEAR(levels[2][cube_texel_index(2, 3, 0, 1)].x, own / cube_texel_solid_angles(2)[1], 1e-7);
    EXPECT_EQ(levels[1][cube_texel_index(4, 3, 0, 2)].x, 0);
}

TEST(CubeMips, KeepTheMeanOverTheSphere) {
    // Exactly, but for rounding, with powers of two. Halving an odd size splits texels by area, not by solid angle: at
    // a face's corner the solid angle of a texel's halves differs by its relative slope, up to 3 a b / (1 + a^2 + b^2)
    // of the texel's width 2/n, a part of the noise that each texel here is.
    Random random(5);
    for (const int n : {4, 32, 256, 17, 61}) {
        CubeTexels cube;
        for (int i = 0; i < 6 * n * n; ++i) cube.emplace_back(static_cast<float>(random.next()));
        const double mean = mean_over_sphere(cube, n);
        const bool power_of_two = (n & (n - 1)) == 0;
        int size = n;
        for (const CubeTexels& level : cube_mips(cube, n)) {
            EXPECT_NEAR(mean_over_sphere(level, size), mean, power_of_two ? 1e-7 : 5e-3) << n << " " << size;
            size /= 2;
        }
    }
}

}  // namespace
}  // namespace hairbake
