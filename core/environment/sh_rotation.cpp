#include "core/environment/sh_rotation.h"

#include <cmath>
#include <numbers>

#include "core/base/assert.h"
#include "core/base/gauss_legendre.h"
#include "core/base/parallel.h"
#include "core/base/spherical_harmonics.h"

namespace hairbake {

using std::numbers::pi;

std::vector<Vec3d> rotate_sh(std::span<const Vec3d> coefficients, int bands, const Matrix3& orthogonal) {
    HAIRBAKE_ASSERT(bands >= 1 && coefficients.size() == std::size_t(bands) * bands);
    const ShBasis basis(bands);
    const Quadrature rule = gauss_legendre(bands);  // exact in z for degree 2 (bands - 1)
    const int azimuths = 2 * bands;                 // exact in phi for |m| + |m'| < 2 bands
    std::vector<std::vector<Vec3d>> partial(bands);
    parallel_for(bands, 1, [&](std::size_t node, std::size_t) {
        std::vector<Vec3d> sums(basis.count());
        std::vector<double> y(basis.count());
        const double z = rule.nodes[node], sine = std::sqrt(1 - z * z);
        for (int k = 0; k < azimuths; ++k) {
            const Vec3d g{sine * std::cos(pi * k / bands), sine * std::sin(pi * k / bands), z};
            basis.evaluate(transform_back(orthogonal, g), y);
            Vec3d value;
            for (int i = 0; i < basis.count(); ++i) value += coefficients[i] * y[i];
            basis.evaluate(g, y);
            value *= rule.weights[node] * pi / bands;
            for (int i = 0; i < basis.count(); ++i) sums[i] += value * y[i];
        }
        partial[node] = std::move(sums);
    });
    std::vector<Vec3d> rotated(basis.count());
    for (const std::vector<Vec3d>& sums : partial)
        for (int i = 0; i < basis.count(); ++i) rotated[i] += sums[i];
    return rotated;
}

}  // namespace hairbake
