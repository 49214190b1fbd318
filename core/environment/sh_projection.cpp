#include "core/environment/sh_projection.h"

#include <cmath>
#include <numbers>

#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/base/spherical_harmonics.h"
#include "core/environment/cube_sh_projection.h"
#include "core/environment/latlong.h"

namespace hairbake {

using std::numbers::pi;

namespace {

// Three channels of one folded row, each [quarter].
struct Channels {
    std::vector<double> r, g, b;
    explicit Channels(std::size_t n) : r(n), g(n), b(n) {}
    void set(std::size_t j, const Vec3d& v) {
        r[j] = v.x;
        g[j] = v.y;
        b[j] = v.z;
    }
};

// A row folded into a quarter circle. Column j is at phi, and its images are at -phi, -pi - phi and pi + phi. The sums
// of cos(m phi) over the row need only the sum (m even) or the difference (m odd) of the images; likewise sin(m phi).
struct FoldedRow {
    Channels cos_even, cos_odd, sin_even, sin_odd;
    explicit FoldedRow(std::size_t n) : cos_even(n), cos_odd(n), sin_even(n), sin_odd(n) {}

    void fold(const Vec3f* row, int width) {
        const int half = width / 2, quarter = (half + 1) / 2;
        for (int j = 0; j < quarter; ++j) {
            const int image = half - 1 - j;
            const Vec3d left(row[j]), right(row[width - 1 - j]);
            const Vec3d even = left + right, odd = left - right;
            if (image == j) {  // phi = -pi/2 exactly: cos(m phi) = 0 for odd m, sin(m phi) = 0 for even m
                cos_even.set(j, even);
                cos_odd.set(j, {});
                sin_even.set(j, {});
                sin_odd.set(j, odd);
                continue;
            }
            const Vec3d left2(row[image]), right2(row[width - 1 - image]);
            const Vec3d even2 = left2 + right2, odd2 = left2 - right2;
            cos_even.set(j, even + even2);
            cos_odd.set(j, even - even2);
            sin_even.set(j, odd - odd2);
            sin_odd.set(j, odd + odd2);
        }
    }
};

double dot_product(const double* a, const double* b, std::size_t n) {
    double sum[4] = {0, 0, 0, 0};  // four chains, so that additions overlap
    std::size_t j = 0;
    for (; j + 4 <= n; j += 4)
        for (int k = 0; k < 4; ++k) sum[k] += a[j + k] * b[j + k];
    for (; j < n; ++j) sum[0] += a[j] * b[j];
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

Vec3d dot_product(const double* table, const Channels& c) {
    const std::size_t n = c.r.size();
    return {dot_product(table, c.r.data(), n), dot_product(table, c.g.data(), n), dot_product(table, c.b.data(), n)};
}

// cos(m phi_j) and sin(m phi_j) over the first quarter of the columns, [bands][quarter].
struct AzimuthTable {
    std::vector<double> cosine, sine;
    AzimuthTable(int bands, int width, std::size_t quarter) : cosine(bands * quarter), sine(bands * quarter) {
        for (int m = 0; m < bands; ++m)
            for (std::size_t j = 0; j < quarter; ++j) {
                // Reduced as an integer number of half steps, so that large m stays exact.
                const long long steps = static_cast<long long>(m) * (2 * static_cast<long long>(j) + 1 - width);
                const double angle = pi * static_cast<double>(steps % (2LL * width)) / width;
                cosine[m * quarter + j] = std::cos(angle);
                sine[m * quarter + j] = std::sin(angle);
            }
    }
};

// Cosine and sine sums of every row, [height][bands] each.
struct RowSums {
    std::vector<Vec3d> cosine, sine;
};

RowSums sum_rows(const EnvironmentMap& map, int bands, const Progress& progress) {
    const std::size_t quarter = (map.width / 2 + 1) / 2;
    const AzimuthTable table(bands, map.width, quarter);
    RowSums sums{std::vector<Vec3d>(std::size_t(map.height) * bands),
                 std::vector<Vec3d>(std::size_t(map.height) * bands)};
    parallel_for(map.height, 8, [&](std::size_t begin, std::size_t end) {
        progress.check();
        FoldedRow row(quarter);
        for (std::size_t y = begin; y < end; ++y) {
            row.fold(map.pixels.data() + y * map.width, map.width);
            for (int m = 0; m < bands; ++m) {
                const double* c = table.cosine.data() + m * quarter;
                const double* s = table.sine.data() + m * quarter;
                sums.cosine[y * bands + m] = dot_product(c, m % 2 ? row.cos_odd : row.cos_even);
                sums.sine[y * bands + m] = dot_product(s, m % 2 ? row.sin_odd : row.sin_even);
            }
        }
    });
    return sums;
}

}  // namespace

std::vector<Vec3d> project_sh(const EnvironmentMap& map, int bands, const Progress& progress) {
    HAIRBAKE_ASSERT(bands >= 1 && bands <= 256 && (map.shape == EnvironmentShape::cube || map.width % 2 == 0));
    if (map.shape == EnvironmentShape::cube) return project_cube_sh(map, bands, progress);
    const RowSums sums = sum_rows(map, bands, progress);
    const LatLongRows rows = latlong_rows(map.width, map.height);
    const ShBasis basis(bands);
    std::vector<Vec3d> coefficients(basis.count());
    parallel_for(bands, 1, [&](std::size_t piece, std::size_t) {
        progress.check();
        const int m = static_cast<int>(piece);
        std::vector<double> legendre(bands - m);
        for (int y = 0; y < map.height; ++y) {
            basis.legendre_column(m, rows.cos_theta[y], rows.sin_theta[y], legendre);
            const double weight = rows.solid_angle[y] * (m == 0 ? 1 : std::numbers::sqrt2);
            const Vec3d cosine = sums.cosine[std::size_t(y) * bands + m] * weight;
            const Vec3d sine = sums.sine[std::size_t(y) * bands + m] * weight;
            for (int l = m; l < bands; ++l) {
                coefficients[l * l + l + m] += cosine * legendre[l - m];
                if (m > 0) coefficients[l * l + l - m] += sine * legendre[l - m];
            }
        }
    });
    return coefficients;
}

}  // namespace hairbake
