#include "core/base/spherical_harmonics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/assert.h"

namespace hairbake {

using std::numbers::pi;

ShBasis::ShBasis(int bands) : bands_(bands) {
    HAIRBAKE_ASSERT(bands >= 1 && bands <= 256);
    double square = 1 / (4 * pi);  // P_mm^2 / sin^2m = (2m + 1) / (4 pi) * product of (2k - 1) / (2k)
    for (int m = 0; m < bands; ++m) {
        if (m > 0) square *= (2 * m + 1.0) / (2 * m);
        first_.push_back(std::sqrt(square));
        column_begin_.push_back(a_.size());
        for (int l = m; l < bands; ++l) {
            const double l2 = double(l) * l, m2 = double(m) * m, k2 = double(l - 1) * (l - 1);
            a_.push_back(l == m ? 0 : std::sqrt((4 * l2 - 1) / (l2 - m2)));
            b_.push_back(l <= m + 1 ? 0 : std::sqrt((k2 - m2) / (4 * k2 - 1)));
        }
    }
}

void ShBasis::run_column(int m, double z, double first, std::span<double> out) const {
    const double* a = a_.data() + column_begin(m);
    const double* b = b_.data() + column_begin(m);
    out[0] = first;
    double before = 0;
    for (int k = 1; k < bands_ - m; ++k) {
        out[k] = a[k] * (z * out[k - 1] - b[k] * before);
        before = out[k - 1];
    }
}

void ShBasis::legendre_column(int m, double z, double sine, std::span<double> out) const {
    run_column(m, z, first_[m] * std::pow(sine, m), out);
}

void ShBasis::evaluate(const Vec3d& direction, std::span<double> values) const {
    HAIRBAKE_ASSERT(values.size() >= static_cast<std::size_t>(count()));
    std::vector<double> column(bands_);
    double re = 1, im = 0;  // (x + i y)^m = sin^m exp(i m phi)
    for (int m = 0; m < bands_; ++m) {
        run_column(m, direction.z, m == 0 ? first_[0] : std::numbers::sqrt2 * first_[m], column);
        for (int l = m; l < bands_; ++l) {
            values[l * l + l + m] = column[l - m] * re;
            if (m > 0) values[l * l + l - m] = column[l - m] * im;
        }
        const double next = re * direction.x - im * direction.y;
        im = re * direction.y + im * direction.x;
        re = next;
    }
}

}  // namespace hairbake
