#include "core/base/spherical_harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/gauss_legendre.h"
#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/environment/sh_projection.h"
#include "core/environment/sh_rotation.h"
#include "tests/support/make_map.h"

namespace hairbake {
namespace {

using std::numbers::pi;
using testing::make_map;
using testing::noise_map;
using testing::one_texel_sun;
using testing::random_direction;

Vec3d evaluate(const std::vector<Vec3d>& coefficients, int bands, const Vec3d& d) {
    std::vector<double> y(bands * bands);
    ShBasis(bands).evaluate(d, y);
    Vec3d sum;
    for (std::size_t i = 0; i < y.size(); ++i) sum += coefficients[i] * y[i];
    return sum;
}

TEST(SphericalHarmonics, TheFirstBandsHaveTheSpecifiedOrderAndSign) {
    const Vec3d d = normalized(Vec3d{0.3, -0.5, 0.7});
    std::vector<double> y(9);
    ShBasis(3).evaluate(d, y);
    const double one = std::sqrt(3 / (4 * pi)), two = std::sqrt(15 / (4 * pi));
    // Closed forms without Condon-Shortley phase; 1e-15: rounding.
    const double expected[] = {std::sqrt(1 / (4 * pi)),
                               one * d.y,
                               one * d.z,
                               one * d.x,
                               two * d.x * d.y,
                               two * d.y * d.z,
                               std::sqrt(5 / (16 * pi)) * (3 * d.z * d.z - 1),
                               two * d.x * d.z,
                               two / 2 * (d.x * d.x - d.y * d.y)};
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(y[i], expected[i], 1e-15) << i;
}

TEST(SphericalHarmonics, TheyAreOrthonormal) {
    // 12 Gauss nodes times 24 azimuths integrate products of degree 22 exactly.
    const int bands = 12;
    const ShBasis basis(bands);
    const Quadrature rule = gauss_legendre(bands);
    std::vector<double> y(basis.count()), gram(std::size_t(basis.count()) * basis.count());
    for (int node = 0; node < bands; ++node)
        for (int k = 0; k < 2 * bands; ++k) {
            const double z = rule.nodes[node], s = std::sqrt(1 - z * z), phi = pi * k / bands;
            basis.evaluate({s * std::cos(phi), s * std::sin(phi), z}, y);
            for (int i = 0; i < basis.count(); ++i)
                for (int j = 0; j < basis.count(); ++j)
                    gram[std::size_t(i) * basis.count() + j] += rule.weights[node] * pi / bands * y[i] * y[j];
        }
    for (int i = 0; i < basis.count(); ++i)
        for (int j = 0; j < basis.count(); ++j) EXPECT_NEAR(gram[std::size_t(i) * basis.count() + j], i == j, 1e-13);
}

TEST(SphericalHarmonics, TheAdditionTheoremHoldsTo128Bands) {
    const int bands = 128;
    const ShBasis basis(bands);
    std::vector<double> ya(basis.count()), yb(basis.count());
    Random random(3);
    for (int k = 0; k < 20; ++k) {
        // Some directions close to the poles, where sin^m underflows.
        const Vec3d a = k < 3 ? normalized(Vec3d{1e-3 * k, 1e-5, 1}) : random_direction(random);
        const Vec3d b = random_direction(random);
        basis.evaluate(a, ya);
        basis.evaluate(b, yb);
        double before = 0, legendre = 1;
        for (int l = 0; l < bands; ++l) {
            double sum = 0;
            for (int i = l * l; i < (l + 1) * (l + 1); ++i) sum += ya[i] * yb[i];
            // sum over m of Y_lm(a) Y_lm(b) = (2l + 1) / (4 pi) P_l(a . b); recurrences lose about l units of rounding
            // of terms that are at most (2l + 1)/(4 pi) = 20.
            EXPECT_NEAR(sum, (2 * l + 1) / (4 * pi) * legendre, 1e-11) << l;
            const double next = ((2 * l + 1) * dot(a, b) * legendre - l * before) / (l + 1);
            before = legendre;
            legendre = next;
        }
    }
}

TEST(SphericalHarmonics, RotatedCoefficientsDescribeTheRotatedFunction) {
    Random random(4);
    const int bands = 9;
    std::vector<Vec3d> c(bands * bands);
    for (Vec3d& v : c) v = {random.next(-1, 1), random.next(-1, 1), random.next(-1, 1)};
    Matrix3 mirror = rotation_matrix({20, 130, -50});
    std::swap(mirror[0], mirror[1]);  // determinant -1
    for (const Matrix3& m : {rotation_matrix({20, 130, -50}), mirror}) {
        const std::vector<Vec3d> rotated = rotate_sh(c, bands, m);
        for (int k = 0; k < 50; ++k) {
            const Vec3d d = random_direction(random);
            // g(M d) = f(d) exactly; 81 terms of order one leave 1e-13.
            EXPECT_LT(length(evaluate(rotated, bands, transform(m, d)) - evaluate(c, bands, d)), 1e-13);
        }
    }
}

TEST(ShProjection, AOneTexelSunGivesTheHarmonicsOfItsDirectionInEveryConvention) {
    const int bands = 16;
    const ShBasis basis(bands);
    std::vector<double> y(basis.count());
    Progress progress;
    for (const LatLong convention : {LatLong::gltf, LatLong::filament, LatLong::openexr})
        for (const auto& [column, row] : {std::pair{5, 3}, {40, 31}, {63, 20}}) {
            const EnvironmentMap map = one_texel_sun(64, column, row, {1, 2, 0}, convention, {10, 200, 33});
            const std::vector<Vec3d> c = rotate_sh(project_sh(map, bands, progress), bands, map_to_world(map));
            basis.evaluate(direction_of(map, {column + 0.5, row + 0.5}), y);
            for (int i = 0; i < basis.count(); ++i)
                // Coefficient = flux * Y; the texel's radiance is rounded to single precision (6e-8), |Y| <= 1.6.
                EXPECT_LT(length(c[i] - Vec3d{1, 2, 0} * y[i]), 4e-7) << i;
        }
}

TEST(ShProjection, TheSeparableFormEqualsTheSumOverTexels) {
    // Height 15 makes half a row odd: the fold's middle texel is its own image.
    const int bands = 20;
    const ShBasis basis(bands);
    std::vector<double> y(basis.count());
    Progress progress;
    for (const int width : {30, 64}) {
        const EnvironmentMap map = noise_map(width, 5);
        const LatLongRows rows = latlong_rows(map.width, map.height);
        std::vector<Vec3d> expected(basis.count());
        for (int row = 0; row < map.height; ++row)
            for (int column = 0; column < width; ++column) {
                basis.evaluate(transform_back(map_to_world(map), direction_of(map, {column + 0.5, row + 0.5})), y);
                for (int i = 0; i < basis.count(); ++i)
                    expected[i] +=
                        Vec3d(map.pixels[std::size_t(row) * width + column]) * (rows.solid_angle[row] * y[i]);
            }
        const std::vector<Vec3d> c = project_sh(map, bands, progress);
        // Both are sums of at most 2048 terms of total size 4 pi in double.
        for (int i = 0; i < basis.count(); ++i) EXPECT_LT(length(c[i] - expected[i]), 1e-12) << i;
    }
}

TEST(ShProjection, ACubesFoldedFormEqualsTheSumOverTexels) {
    // Odd sizes have texels that are their own mirror images. Bands 1 to 20 hold every parity in x, y and z.
    const int bands = 20;
    const ShBasis basis(bands);
    std::vector<double> y(basis.count());
    Progress progress;
    for (const int size : {1, 2, 7, 24}) {
        const EnvironmentMap map = testing::noise_cube(size, 5, {10, 20, 30});
        const TexelSolidAngles omega = texel_solid_angles(map);
        std::vector<Vec3d> expected(basis.count());
        for (int row = 0; row < map.height; ++row)
            for (int column = 0; column < size; ++column) {
                basis.evaluate(transform_back(map_to_world(map), direction_of(map, {column + 0.5, row + 0.5})), y);
                for (int i = 0; i < basis.count(); ++i)
                    expected[i] += Vec3d(map.pixels[std::size_t(row) * size + column]) * (omega.at(column, row) * y[i]);
            }
        const std::vector<Vec3d> c = project_sh(map, bands, progress);
        // Sums of at most 3456 terms of total size 4 pi in double; directions of the two ways differ by 1e-16 times
        // the slope of 20 bands.
        for (int i = 0; i < basis.count(); ++i) EXPECT_LT(length(c[i] - expected[i]), 1e-12) << size << ' ' << i;
    }
}

TEST(ShProjection, ThreadsDoNotChangeABitOfACubes) {
    const EnvironmentMap map = testing::noise_cube(37, 7);
    std::vector<Vec3d> c[2];
    for (int k = 0; k < 2; ++k)
        with_threads(1 + 6 * k, [&] {
            Progress progress;
            c[k] = project_sh(map, 12, progress);
        });
    EXPECT_EQ(c[0], c[1]);
}

TEST(ShProjection, ASmoothFunctionComesBackWithSecondOrderInTheTexelSize) {
    // Texels hold the value at their centres, the weights are exact: a midpoint rule. Twice the texels, a quarter of
    // the error.
    const auto smooth = [](const Vec3d& d) { return Vec3d(1 + d.y + 0.5 * (3 * d.y * d.y - 1)); };
    const auto worst_error = [&](int width) {
        Progress progress;
        const EnvironmentMap map = make_map(width, smooth, LatLong::openexr);
        const std::vector<Vec3d> c = rotate_sh(project_sh(map, 6, progress), 6, map_to_world(map));
        Random random(6);
        double worst = 0;
        for (int k = 0; k < 50; ++k) {
            const Vec3d d = random_direction(random);
            worst = std::max(worst, std::abs(evaluate(c, 6, d).y - smooth(d).y));
        }
        return worst;
    };
    const double coarse = worst_error(256), fine = worst_error(512);
    EXPECT_NEAR(coarse / fine, 4, 0.1);  // the next order is (pi / 128)^2 = 6e-4 of it, times derivatives
    EXPECT_LT(fine, 1e-3);
}

TEST(ShProjection, ThreadsDoNotChangeABit) {
    const EnvironmentMap map = noise_map(128, 7);
    Progress progress;
    std::vector<Vec3d> results[3];
    const int threads[] = {1, 2, 7};
    for (int k = 0; k < 3; ++k)
        with_threads(threads[k], [&] {
            results[k] = rotate_sh(project_sh(map, 12, progress), 12, rotation_matrix({10, 20, 30}));
        });
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace hairbake
