#include "core/environment/cube_sh_projection.h"

#include <array>
#include <cmath>
#include <cstdlib>

#include "core/base/parallel.h"
#include "core/base/spherical_harmonics.h"
#include "core/environment/cube_map.h"

namespace hairbake {
namespace {

constexpr std::size_t pieces = 48;  // of the sum; each piece has its own bands^2 sums
constexpr int octants = 8;

// Values at the eight images of a direction; the index adds 1 where x is negated, 2 for y and 4 for z. sum_with_signs()
// turns them into their sums with the signs of a function that is odd in x (1), y (2), z (4).
using Images = std::array<Vec3d, octants>;

void sum_with_signs(Images& v) {
    for (int bit = 1; bit < octants; bit *= 2)
        for (int i = 0; i < octants; ++i) {
            if (i & bit) continue;
            const Vec3d low = v[i], high = v[i | bit];
            v[i] = low + high;
            v[i | bit] = low - high;
        }
}

// The axes in which each harmonic is odd: Y_lm is P_l|m|(z) times cos(m phi) for m >= 0, sin(|m| phi) for m < 0.
std::vector<std::uint8_t> parities(int bands) {
    std::vector<std::uint8_t> parity;
    for (int l = 0; l < bands; ++l)
        for (int m = -l; m <= l; ++m) {
            const int order = std::abs(m);
            const bool x = m < 0 ? order % 2 == 0 : order % 2 == 1, y = m < 0, z = (l + order) % 2 == 1;
            parity.push_back(static_cast<std::uint8_t>(x + 2 * y + 4 * z));
        }
    return parity;
}

Vec3d mirrored(const Vec3d& d, int signs) {
    return {signs & 1 ? -d.x : d.x, signs & 2 ? -d.y : d.y, signs & 4 ? -d.z : d.z};
}

// The quarter of a face on the positive side of both its axes, and its images on this and the opposite face.
struct Projector {
    const EnvironmentMap& map;
    const TexelSolidAngles solid_angles;
    const ShBasis basis;
    const std::vector<std::uint8_t> parity;

    Projector(const EnvironmentMap& m, int bands)
        : map(m), solid_angles(texel_solid_angles(m)), basis(bands), parity(parities(bands)) {}

    int first() const { return map.width / 2; }  // of the texels with a coordinate >= 0
    int quarter() const { return map.width - first(); }

    // A row or column through the middle of the face is its own image in one axis: half each time.
    double share(int row, int column) const {
        const bool odd = map.width % 2 == 1;
        return (odd && row == first() ? 0.5 : 1) * (odd && column == first() ? 0.5 : 1);
    }

    void add_texel(int axis, int row, int column, std::vector<double>& y, std::vector<Vec3d>& sums) const {
        const double u = (2 * column + 1) / double(map.width) - 1, v = (2 * row + 1) / double(map.width) - 1;
        const Vec3d d = axis == 0 ? Vec3d{1, u, v} : axis == 1 ? Vec3d{v, 1, u} : Vec3d{u, v, 1};
        Images values;
        for (int i = 0; i < octants; ++i) values[i] = Vec3d(map.pixels[cube_texel_of(map.width, mirrored(d, i))]);
        sum_with_signs(values);
        const double weight = solid_angles.at(column, row) * share(row, column);
        for (Vec3d& value : values) value *= weight;
        basis.evaluate(normalized(d), y);
        for (int i = 0; i < basis.count(); ++i) sums[i] += values[parity[i]] * y[i];
    }
};

}  // namespace

std::vector<Vec3d> project_cube_sh(const EnvironmentMap& map, int bands, const Progress& progress) {
    const Projector projector(map, bands);
    const std::size_t rows = 3 * std::size_t(projector.quarter());
    std::vector<std::vector<Vec3d>> sums(pieces, std::vector<Vec3d>(projector.basis.count()));
    parallel_for(pieces, 1, [&](std::size_t piece, std::size_t) {
        std::vector<double> y(projector.basis.count());
        for (std::size_t i = piece * rows / pieces; i < (piece + 1) * rows / pieces; ++i) {
            progress.check();
            const int axis = int(i / projector.quarter()), row = projector.first() + int(i % projector.quarter());
            for (int column = projector.first(); column < map.width; ++column)
                projector.add_texel(axis, row, column, y, sums[piece]);
        }
    });
    for (std::size_t piece = 1; piece < pieces; ++piece)
        for (std::size_t i = 0; i < sums[0].size(); ++i) sums[0][i] += sums[piece][i];
    return sums[0];
}

}  // namespace hairbake
