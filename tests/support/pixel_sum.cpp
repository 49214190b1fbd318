#include "tests/support/pixel_sum.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/environment/cube_map.h"
#include "core/environment/latlong.h"

namespace hairbake::testing {
namespace {

// log2 of the exponent when it is a power of two, otherwise -1.
int squarings(double exponent) {
    const int n = exponent >= 1 ? std::ilogb(exponent) : 0;
    return exponent == std::ldexp(1.0, n) ? n : -1;
}

double power(double base, double exponent, int squares) {
    if (base <= 0) return 0;
    if (squares < 0) return exponent == 0 ? 1 : std::pow(base, exponent);
    for (int k = 0; k < squares; ++k) base *= base;
    return base;
}

void sum_one(const EnvironmentMap& map, const LatLongRows& rows, const LatLongColumns& columns, const Vec3d& t,
             double exponent, int maps, Vec3d* sums) {
    std::vector<double> cos_view, sin_view;
    for (int m = 0; m < maps; ++m) {
        cos_view.push_back(std::cos(std::numbers::pi * m / (maps - 1)));
        sin_view.push_back(std::sin(std::numbers::pi * m / (maps - 1)));
    }
    const int squares = squarings(exponent);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const double s = rows.sin_theta[y];
            const double cosine = t.x * s * columns.cos_phi[x] + t.y * s * columns.sin_phi[x] + t.z * rows.cos_theta[y];
            const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
            const Vec3d flux = Vec3d(map.pixels[std::size_t(y) * map.width + x]) * rows.solid_angle[y];
            sums[0] += flux * sine;
            for (int m = 0; m < maps; ++m) {
                const double k = power(sine * sin_view[m] - cosine * cos_view[m], exponent, squares);
                if (k > 0) sums[1 + m] += flux * k;
            }
        }
}

}  // namespace

std::vector<Vec3d> sum_over_pixels(const EnvironmentMap& map, std::span<const Vec3d> tangents, double exponent,
                                   int maps) {
    const LatLongRows rows = latlong_rows(map.width, map.height);
    const LatLongColumns columns = latlong_columns(map.width);
    const Matrix3 to_world = map_to_world(map);
    std::vector<Vec3d> sums(tangents.size() * (1 + maps));
    parallel_for(tangents.size(), 1, [&](std::size_t i, std::size_t) {
        sum_one(map, rows, columns, transform_back(to_world, tangents[i]), exponent, maps, sums.data() + i * (1 + maps));
    });
    return sums;
}

MapError compare(const IrradianceMaps& maps, std::span<const std::size_t> texels, const std::vector<Vec3d>& truth) {
    const std::size_t stride = 1 + maps.specular.size();
    double largest = 0, diffuse = 0, specular = 0, specular_truth = 0;
    for (std::size_t i = 0; i < texels.size(); ++i)
        for (std::size_t k = 0; k < stride; ++k) {
            const Vec3d& expected = truth[i * stride + k];
            const Vec3d difference = Vec3d(k == 0 ? maps.diffuse[texels[i]] : maps.specular[k - 1][texels[i]]) - expected;
            largest = std::max({largest, expected.x, expected.y, expected.z});
            (k == 0 ? diffuse : specular) += dot(difference, difference);
            if (k > 0) specular_truth += dot(expected, expected);
        }
    const double count = 3.0 * double(texels.size());
    MapError error;
    error.diffuse = std::sqrt(diffuse / count) / largest;
    error.specular = std::sqrt(specular / (count * double(stride - 1))) / largest;
    error.all = std::sqrt((diffuse + specular) / (count * double(stride))) / largest;
    error.specular_relative = std::sqrt(specular / specular_truth);
    return error;
}

TexelSample sample_texels(int face_size, int step) {
    TexelSample sample;
    const std::size_t count = std::size_t(cube_faces) * face_size * face_size;
    for (std::size_t i = 0; i < count; i += step) {
        sample.texels.push_back(i);
        sample.tangents.push_back(cube_texel_direction(face_size, int(i / face_size / face_size),
                                                       int(i / face_size % face_size), int(i % face_size)));
    }
    return sample;
}

}  // namespace hairbake::testing
