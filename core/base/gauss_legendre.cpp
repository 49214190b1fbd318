#include "core/base/gauss_legendre.h"

#include <cmath>
#include <numbers>

#include "core/base/assert.h"

namespace hairbake {
namespace {

struct Legendre {
    double value, slope;
};

Legendre legendre(int degree, double x) {
    double previous = 0, value = 1;
    for (int l = 1; l <= degree; ++l) {
        const double next = ((2 * l - 1) * x * value - (l - 1) * previous) / l;
        previous = value;
        value = next;
    }
    return {value, degree * (x * value - previous) / (x * x - 1)};
}

}  // namespace

Quadrature gauss_legendre(int count) {
    HAIRBAKE_ASSERT(count >= 1);
    Quadrature rule{std::vector<double>(count), std::vector<double>(count)};
    for (int i = 0; i < (count + 1) / 2; ++i) {
        double x = -std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), step = 1;
        for (int k = 0; k < 10 && std::abs(step) > 1e-15; ++k) {
            const Legendre p = legendre(count, x);
            step = p.value / p.slope;
            x -= step;
        }
        const double slope = legendre(count, x).slope;
        rule.nodes[i] = x;
        rule.nodes[count - 1 - i] = -x;  // symmetric; the middle one of an odd count is 0
        rule.weights[i] = rule.weights[count - 1 - i] = 2 / ((1 - x * x) * slope * slope);
    }
    return rule;
}

}  // namespace hairbake
