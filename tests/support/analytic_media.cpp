#include "tests/support/analytic_media.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/gauss_legendre.h"

namespace hairbake::test_support {

double ball_transmittance(double extinction, double radius, double r) {
    static const Quadrature rule = gauss_legendre(400);
    double sum = 0;
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double mu = rule.nodes[k], across = r * r * (1 - mu * mu);
        const double way = -r * mu + std::sqrt(std::max(0.0, radius * radius - across));
        sum += rule.weights[k] * std::exp(-extinction * way);
    }
    return sum / 2;
}

double parallel_ball_centre(double depth) {
    static const Quadrature rule = gauss_legendre(200);
    double sum = 0;
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double sine = std::sin(std::numbers::pi / 2 * (rule.nodes[k] + 1));
        sum += rule.weights[k] * std::numbers::pi / 2 * sine * std::exp(-depth * sine);
    }
    return sum / 2;
}

double e2(double x) { return x <= 0 ? 1 : std::exp(-x) + x * std::expint(-x); }

double slab_transmittance(double extinction, double h, double z) {
    return 0.5 * (e2(extinction * z) + e2(extinction * (h - z)));
}

}  // namespace hairbake::test_support
