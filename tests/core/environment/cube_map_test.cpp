#include "core/environment/cube_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/random.h"
#include "tests/support/make_map.h"

namespace hairbake {
namespace {

using testing::random_direction;

CubeTexels numbered(int size) {
    CubeTexels texels(std::size_t(cube_faces) * size * size);
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = Vec3f(float(i), 1, -float(i));
    return texels;
}

TEST(CubeMap, TexelSolidAnglesSumToTheSphere) {
    for (const int size : {1, 4, 16, 256}) {
        const std::vector<double> angles = cube_texel_solid_angles(size);
        // 4 pi to 1e-12: the corners' arc tangents telescope, what is left is the rounding of 65,536 additions.
        EXPECT_NEAR(6 * std::accumulate(angles.begin(), angles.end(), 0.0), 4 * std::numbers::pi, 1e-12) << size;
    }
    const std::vector<double> angles = cube_texel_solid_angles(16);
    // docs/math.md, "Solid angles": the largest texel (centre) over the smallest (corner) is 4.506, given to four
    // digits.
    EXPECT_NEAR(*std::max_element(angles.begin(), angles.end()) / *std::min_element(angles.begin(), angles.end()),
                4.506, 5e-4);
}

TEST(CubeMap, FacesAreOrientedAsInOpenGl) {
    // (a, b) = (0.5, 0.25) put into the table of cube_map.h by hand; 1e-15 is rounding of the normalisation.
    const Vec3d expected[] = {{1, -0.25, -0.5}, {-1, -0.25, 0.5}, {0.5, 1, 0.25},
                              {0.5, -1, -0.25}, {0.5, -0.25, 1},  {-0.5, -0.25, -1}};
    for (int face = 0; face < cube_faces; ++face)
        EXPECT_LT(length(cube_direction({face, 0.5, 0.25}) - normalized(expected[face])), 1e-15)
            << cube_face_name(face);
    // Texel (row 0, column n-1) is the one at the top right: a > 0, b < 0.
    const Vec3d top_right = cube_texel_direction(4, 4, 0, 3);
    EXPECT_LT(length(top_right - normalized(Vec3d{0.75, 0.75, 1})), 1e-15);
}

TEST(CubeMap, EveryTexelIsFoundAtItsOwnCentreAndOpposite) {
    for (const int size : {4, 7, 16})
        for (std::size_t i = 0; i < std::size_t(cube_faces) * size * size; ++i) {
            const Vec3d d = cube_texel_direction(size, int(i / size / size), int(i / size % size), int(i % size));
            EXPECT_EQ(cube_texel_of(size, d), i);
            EXPECT_EQ(cube_texel_of(size, -d), cube_antipode(size, i));
        }
}

TEST(CubeMap, PointAndDirectionAreInverse) {
    Random random(1);
    for (int k = 0; k < 1000; ++k) {
        const Vec3d d = random_direction(random);
        // Two divisions and a normalisation: a few units of 2.2e-16.
        EXPECT_LT(length(cube_direction(cube_point(d * 3.0)) - d), 1e-15);
    }
}

TEST(CubeMap, LookingUpATexelCentreGivesTheTexel) {
    const CubeTexels texels = numbered(5);
    for (std::size_t i = 0; i < texels.size(); ++i)
        // Weights are off by rounding (1e-15 times values up to 150).
        EXPECT_NEAR(sample_cube(texels, 5, cube_texel_direction(5, int(i / 25), int(i / 5 % 5), int(i % 5))).x,
                    double(i), 1e-11);
}

TEST(CubeMap, LookUpIsContinuousAcrossEveryEdge) {
    // Both faces' bilinear forms give the same value on their edge: halfway between the two rows of texels that meet
    // there. Directions 2e-9 apart may differ by slope (150 * size / 2) * 2e-9.
    const int size = 8;
    const CubeTexels texels = numbered(size);
    for (int face = 0; face < cube_faces; ++face)
        for (int side = 0; side < 4; ++side)
            for (double along = -0.99; along < 1; along += 0.0371) {
                const auto at = [&](double across) {
                    const double edge = side % 2 ? across : -across;
                    return side < 2 ? CubePoint{face, edge, along} : CubePoint{face, along, edge};
                };
                const Vec3d inside = sample_cube(texels, size, cube_direction(at(1 - 1e-9)));
                const Vec3d outside = sample_cube(texels, size, cube_direction(at(1 + 1e-9)));
                EXPECT_LT(length(inside - outside), 1e-5) << face << ' ' << side << ' ' << along;
                EXPECT_NEAR(inside.y, 1, 1e-12);
            }
}

TEST(CubeMap, AtACornerTheThreeTexelsThatMeetAreAveraged) {
    const int size = 4;
    const CubeTexels texels = numbered(size);
    for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0})
            for (const double z : {-1.0, 1.0}) {
                // The texels nearest to the corner: the ones found a little off it towards each axis.
                double mean = 0;
                for (int axis = 0; axis < 3; ++axis) {
                    Vec3d d{x, y, z};
                    d[axis] *= 1.01;
                    mean += double(cube_texel_of(size, d)) / 3;
                }
                // Three neighbours with weight 1/4 each and their mean with the last quarter: their mean. 1e-9:
                // rounding.
                EXPECT_NEAR(sample_cube(texels, size, {x, y, z}).x, mean, 1e-9);
            }
}

}  // namespace
}  // namespace hairbake
