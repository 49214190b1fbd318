#include "core/base/gauss_legendre.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hairbake {
namespace {

TEST(GaussLegendre, PolynomialsUpToTwiceTheCountAreExact) {
    for (const int count : {1, 2, 5, 16}) {
        const Quadrature rule = gauss_legendre(count);
        for (int degree = 0; degree <= 2 * count - 1; ++degree) {
            double sum = 0;
            for (int i = 0; i < count; ++i) sum += rule.weights[i] * std::pow(rule.nodes[i], degree);
            // Integral of x^n over [-1, 1]: 2 / (n + 1) for even n, 0 for odd. 1e-14: rounding of 16 terms.
            EXPECT_NEAR(sum, degree % 2 ? 0 : 2.0 / (degree + 1), 1e-14) << count << ' ' << degree;
        }
    }
}

TEST(GaussLegendre, ManyNodesIntegrateASharpLobe) {
    const Quadrature rule = gauss_legendre(512);
    double sum = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        sum += rule.weights[i] * std::exp(-400 * rule.nodes[i] * rule.nodes[i]);
        if (i > 0) {
            EXPECT_LT(rule.nodes[i - 1], rule.nodes[i]);
        }
    }
    // sqrt(pi / 400), the tails beyond 1 are e^-400.
    EXPECT_NEAR(sum, std::sqrt(3.14159265358979324 / 400), 1e-13);
}

}  // namespace
}  // namespace hairbake
