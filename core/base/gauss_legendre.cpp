#include "core/base/gauss_legendre.h"

#include <cmath>
#include <numbers>

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
    Quadrature rule{std::vector<double>(count), std::vector<double>(count)};
    for (int i = 0; i < count; ++i) {
        double x = -std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
        for (int step = 0; step < 8; ++step) {
            const Legendre p = legendre(count, x);
            x -= p.value / p.slope;
        }
        const double slope = legendre(count, x).slope;
        rule.nodes[i] = x;
        rule.weights[i] = 2 / ((1 - x * x) * slope * slope);
    }
    return rule;
}

}  // namespace hairbake
