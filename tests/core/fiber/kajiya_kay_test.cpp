#include "core/fiber/kajiya_kay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace hairbake {
namespace {

using std::numbers::pi;

// 2 pi * integral of f(theta) sin(theta) by the midpoint rule: independent of the Gauss rule in use.
double zonal_integral(const std::function<double(double theta)>& f, int steps = 200000) {
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double theta = pi * (i + 0.5) / steps;
        sum += f(theta) * std::sin(theta);
    }
    return 2 * pi * pi / steps * sum;
}

Vec3d at_angle(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

TEST(KajiyaKay, VectorsAndAnglesAgreeAndTheMirrorDirectionGivesOne) {
    const Vec3d t{0, 0, 1};
    for (double light = 0.1; light < 3.1; light += 0.2)
        for (double eye = 0.05; eye < 3.1; eye += 0.3) {
            const Vec3d l = at_angle(light, 0.7), e = at_angle(eye, -2);
            EXPECT_NEAR(kajiya_kay_diffuse(t, l), std::sin(light), 1e-15);
            // Powers of 5 enlarge rounding fivefold.
            EXPECT_NEAR(kajiya_kay_specular(t, l, e, 5), kajiya_kay_specular(light, eye, 5), 5e-15);
        }
    // theta_eye = pi - theta_light is the mirror cone (docs/math.md, "The Kajiya-Kay kernels"): exactly one for any
    // exponent.
    EXPECT_NEAR(kajiya_kay_specular(t, at_angle(0.8, 0), at_angle(pi - 0.8, 2), 64), 1, 1e-13);
    // The retro direction is not lit although 64 is even: the clamp that Xing's equations lack.
    EXPECT_EQ(kajiya_kay_specular(t, at_angle(0.2, 0), at_angle(0.2, 0), 64), 0);
}

TEST(KajiyaKay, ExponentZeroIsTheIndicatorOfAPositiveCosine) {
    EXPECT_EQ(clamped_power(1e-9, 0), 1);
    EXPECT_EQ(clamped_power(0, 0), 0);
    EXPECT_EQ(clamped_power(-0.5, 0), 0);
    EXPECT_EQ(clamped_power(0, 1), 0);
    EXPECT_EQ(clamped_power(0.25, 0.5), 0.5);
}

TEST(KajiyaKay, DiffuseZonalCoefficientsMatchQuadrature) {
    const std::vector<double> lambda = diffuse_zonal(24);
    EXPECT_DOUBLE_EQ(lambda[0], pi * pi);
    for (int l = 0; l < 24; ++l)
        // Midpoint rule with 2e5 steps: (pi / 2e5)^2 / 24 * derivatives (l^2 = 576) = 6e-9.
        EXPECT_NEAR(lambda[l], zonal_integral([&](double x) { return std::sin(x) * std::legendre(l, std::cos(x)); }),
                    1e-8);
}

TEST(KajiyaKay, SpecularZonalCoefficientsMatchQuadrature) {
    for (const double exponent : {0.0, 1.0, 5.0, 64.0, 300.5, 4096.0})
        for (const double view : {0.0, 0.4, pi / 2, 2.2, pi}) {
            const std::vector<double> lambda = specular_zonal(20, exponent, view);
            for (const int l : {0, 1, 2, 7, 19})
                // p = 0 jumps: the midpoint rule is wrong by up to half a step there, 2 pi * pi / 4e5 = 5e-5.
                EXPECT_NEAR(lambda[l], zonal_integral([&](double x) {
                                return kajiya_kay_specular(x, view, exponent) * std::legendre(l, std::cos(x));
                            }),
                            exponent == 0 ? 5e-5 : 2e-8)
                    << exponent << ' ' << view << ' ' << l;
        }
}

TEST(KajiyaKay, SpecularConstantsHaveTheirClosedForms) {
    // p = 5, theta' = pi/2: 2 pi * integral of sin^6 = 2 pi * 5 pi / 16 = 5 pi^2 / 8.
    EXPECT_NEAR(specular_zonal(1, 5, pi / 2)[0], 5 * pi * pi / 8, 1e-12);
    // theta' on the axis: 2 pi * integral over a hemisphere of cos^p sin = 2 pi / (p + 1) (docs/math.md, "The
    // irradiance maps").
    for (const double p : {0.0, 1.0, 5.0, 64.0, 4096.0}) {
        EXPECT_NEAR(specular_zonal(1, p, 0)[0], 2 * pi / (p + 1), 1e-12);
        EXPECT_NEAR(specular_zonal(1, p, pi)[0], 2 * pi / (p + 1), 1e-12);
    }
}

TEST(KajiyaKay, ReversingTheViewFlipsOddBands) {
    // k(pi - theta, pi - view) = k(theta, view) and P_l(-x) = (-1)^l P_l(x).
    const std::vector<double> one = specular_zonal(16, 64, 0.9), other = specular_zonal(16, 64, pi - 0.9);
    for (int l = 0; l < 16; ++l) EXPECT_NEAR(one[l], (l % 2 ? -1 : 1) * other[l], 1e-13);
}

TEST(KajiyaKay, BandsHoldTheEnergyOfTheKernel) {
    // Parseval: sum lambda_l^2 (2l + 1) / (4 pi) = integral of k^2. docs/math.md, "Spherical harmonics": 24 bands hold
    // 99.99 % at p = 64; the sine's six coefficients of l = 0, 2 hold 99.756 %.
    const auto energy = [](const std::vector<double>& lambda) {
        double sum = 0;
        for (std::size_t l = 0; l < lambda.size(); ++l) sum += lambda[l] * lambda[l] * (2.0 * double(l) + 1) / (4 * pi);
        return sum;
    };
    EXPECT_NEAR(energy(diffuse_zonal(3)) / diffuse_energy(), 0.99756, 1e-5);
    for (const double view : {0.0, 0.5, pi / 2}) {
        EXPECT_GT(energy(specular_zonal(24, 64, view)) / specular_energy(64, view), 0.9998);
        EXPECT_NEAR(energy(specular_zonal(100, 64, view)), specular_energy(64, view), 1e-10);
        const double eight = energy(specular_zonal(8, 64, view)) / specular_energy(64, view);
        EXPECT_GT(eight, 0.62);
        EXPECT_LT(eight, 0.85);
    }
}

}  // namespace
}  // namespace hairbake
