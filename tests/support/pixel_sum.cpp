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

// k[x] = max(0, k[x])^p
void raise(std::vector<double>& k, double exponent) {
    const int squares = squarings(exponent);
    for (double& value : k) value = value > 0 ? value : 0;
    if (squares < 0)
        for (double& value : k) value = value > 0 ? (exponent == 0 ? 1 : std::pow(value, exponent)) : 0;
    for (int s = 0; s < squares; ++s)
        for (double& value : k) value *= value;
}

// Sum of flux * kernel over a row, in four chains so that additions overlap.
double weighted_sum(const std::vector<double>& flux, const std::vector<double>& kernel) {
    double sum[4] = {0, 0, 0, 0};
    std::size_t x = 0;
    for (; x + 4 <= flux.size(); x += 4)
        for (int c = 0; c < 4; ++c) sum[c] += flux[x + c] * kernel[x + c];
    for (; x < flux.size(); ++x) sum[0] += flux[x] * kernel[x];
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

// One row of the map: flux by channel, and for every tangent the sums over it.
struct Row {
    std::vector<double> red, green, blue, cosine, sine, kernel;
    explicit Row(int width) : red(width), green(width), blue(width), cosine(width), sine(width), kernel(width) {}

    void load(const Vec3f* pixels, double solid_angle) {
        for (std::size_t x = 0; x < red.size(); ++x) {
            red[x] = pixels[x].x * solid_angle;
            green[x] = pixels[x].y * solid_angle;
            blue[x] = pixels[x].z * solid_angle;
        }
    }
    void point(const LatLongColumns& columns, const Vec3d& t, double sin_theta, double cos_theta) {
        for (std::size_t x = 0; x < red.size(); ++x) {
            const double c = (t.x * columns.cos_phi[x] + t.y * columns.sin_phi[x]) * sin_theta + t.z * cos_theta;
            const double below = 1 - c * c;
            cosine[x] = c;
            sine[x] = std::sqrt(below > 0 ? below : 0);
        }
    }
    Vec3d sum(const std::vector<double>& k) const {
        return {weighted_sum(red, k), weighted_sum(green, k), weighted_sum(blue, k)};
    }
};

// Of a cube: texel by texel.
void sum_one_of_cube(const EnvironmentMap& map, const TexelSolidAngles& omega, const Vec3d& t, double exponent,
                     int maps, Vec3d* sums) {
    std::vector<double> kernel(maps);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const Vec3d flux = Vec3d(map.pixels[std::size_t(y) * map.width + x]) * omega.at(x, y);
            const double cosine = dot(direction_of(map, {x + 0.5, y + 0.5}), t);
            const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
            for (int m = 0; m < maps; ++m) {
                const double theta = std::numbers::pi * m / (maps - 1);
                kernel[m] = sine * std::sin(theta) - cosine * std::cos(theta);
            }
            raise(kernel, exponent);
            sums[0] += flux * sine;
            for (int m = 0; m < maps; ++m) sums[1 + m] += flux * kernel[m];
        }
}

void sum_one(const EnvironmentMap& map, const LatLongRows& rows, const LatLongColumns& columns, const Vec3d& t,
             double exponent, int maps, Vec3d* sums) {
    Row row(map.width);
    for (int y = 0; y < map.height; ++y) {
        row.load(map.pixels.data() + std::size_t(y) * map.width, rows.solid_angle[y]);
        row.point(columns, t, rows.sin_theta[y], rows.cos_theta[y]);
        sums[0] += row.sum(row.sine);
        for (int m = 0; m < maps; ++m) {
            const double theta = std::numbers::pi * m / (maps - 1), c = std::cos(theta), s = std::sin(theta);
            for (int x = 0; x < map.width; ++x) row.kernel[x] = row.sine[x] * s - row.cosine[x] * c;
            raise(row.kernel, exponent);
            sums[1 + m] += row.sum(row.kernel);
        }
    }
}

}  // namespace

std::vector<Vec3d> sum_over_pixels(const EnvironmentMap& map, std::span<const Vec3d> tangents, double exponent,
                                   int maps) {
    std::vector<Vec3d> sums(tangents.size() * (1 + maps));
    if (map.shape == EnvironmentShape::cube) {
        const TexelSolidAngles omega = texel_solid_angles(map);
        parallel_for(tangents.size(), 1, [&](std::size_t i, std::size_t) {
            sum_one_of_cube(map, omega, tangents[i], exponent, maps, sums.data() + i * (1 + maps));
        });
        return sums;
    }
    const LatLongRows rows = latlong_rows(map.width, map.height);
    const LatLongColumns columns = latlong_columns(map.width);
    const Matrix3 to_world = map_to_world(map);
    parallel_for(tangents.size(), 1, [&](std::size_t i, std::size_t) {
        sum_one(map, rows, columns, transform_back(to_world, tangents[i]), exponent, maps,
                sums.data() + i * (1 + maps));
    });
    return sums;
}

double largest_of(const CubeTexels& texels) {
    float largest = 0;
    for (const Vec3f& v : texels) largest = std::max({largest, v.x, v.y, v.z});
    return largest;
}

MapError compare(const IrradianceMaps& maps, std::span<const std::size_t> texels, const std::vector<Vec3d>& truth) {
    const std::size_t stride = 1 + maps.specular.size();
    double largest_diffuse = largest_of(maps.diffuse), largest_specular = 0, diffuse = 0, specular = 0, specular_truth = 0;
    for (const CubeTexels& cube : maps.specular) largest_specular = std::max(largest_specular, largest_of(cube));
    for (std::size_t i = 0; i < texels.size(); ++i)
        for (std::size_t k = 0; k < stride; ++k) {
            const Vec3d& expected = truth[i * stride + k];
            const Vec3d difference =
                Vec3d(k == 0 ? maps.diffuse[texels[i]] : maps.specular[k - 1][texels[i]]) - expected;
            double& largest = k == 0 ? largest_diffuse : largest_specular;
            largest = std::max({largest, expected.x, expected.y, expected.z});
            (k == 0 ? diffuse : specular) += dot(difference, difference);
            if (k > 0) specular_truth += dot(expected, expected);
        }
    const double count = 3.0 * double(texels.size());
    MapError error;
    error.diffuse = std::sqrt(diffuse / count) / largest_diffuse;
    error.specular = std::sqrt(specular / (count * double(stride - 1))) / largest_specular;
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
