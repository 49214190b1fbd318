#include "core/fiber/kajiya_kay.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/gauss_legendre.h"

namespace hairbake {

using std::numbers::pi;

double specular_lobe(double cosine, double exponent) {
    if (cosine <= 0) return 0;
    return exponent == 0 ? 1 : std::pow(cosine, exponent);
}

double kajiya_kay_diffuse(const Vec3d& tangent, const Vec3d& to_light) { return length(cross(tangent, to_light)); }

double kajiya_kay_specular(const Vec3d& tangent, const Vec3d& to_light, const Vec3d& to_eye, double exponent) {
    const double sines = length(cross(tangent, to_light)) * length(cross(tangent, to_eye));
    return specular_lobe(sines - dot(tangent, to_light) * dot(tangent, to_eye), exponent);
}

double kajiya_kay_specular(double theta_light, double theta_view, double exponent) {
    return specular_lobe(-std::cos(theta_light + theta_view), exponent);
}

std::vector<double> diffuse_zonal(int bands) {
    std::vector<double> lambda(bands, 0.0);
    double value = pi * pi;
    for (int l = 0; l < bands; l += 2) {
        if (l > 0) value *= double(l - 3) * (l - 1) / (double(l) * (l + 2));
        lambda[l] = value;
    }
    return lambda;
}

std::vector<double> specular_zonal(int bands, double exponent, double theta_view) {
    // u = pi - theta - theta_view is the angle from the lobe's peak; beyond `reach` the kernel is below 1e-20.
    const double reach = exponent > 0 ? std::acos(std::exp(-46 / std::max(exponent, 1e-3))) : pi / 2;
    const double low = std::max(0.0, pi - theta_view - reach), high = std::min(pi, pi - theta_view + reach);
    std::vector<double> lambda(bands, 0.0);
    if (high <= low) return lambda;
    const Quadrature rule = gauss_legendre(256);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double theta = 0.5 * (low + high) + 0.5 * (high - low) * rule.nodes[i];
        const double weight =
            pi * (high - low) * rule.weights[i] * std::sin(theta) * kajiya_kay_specular(theta, theta_view, exponent);
        const double x = std::cos(theta);
        double previous = 0, legendre = 1;
        for (int l = 0; l < bands; ++l) {
            lambda[l] += weight * legendre;
            const double next = ((2 * l + 1) * x * legendre - l * previous) / (l + 1);
            previous = legendre;
            legendre = next;
        }
    }
    return lambda;
}

double diffuse_energy() { return 8 * pi / 3; }

double specular_energy(double exponent, double theta_view) { return specular_zonal(1, 2 * exponent, theta_view)[0]; }

}  // namespace hairbake
