#include "core/irradiance/interpolation_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/parallel.h"
#include "core/environment/cube_map.h"
#include "core/irradiance/kernel_sum.h"

namespace hairbake {

using std::numbers::pi;

namespace {

constexpr int tangent_size = 16;
constexpr int samples = 4096;  // of the sum of angles, over [0, 2 pi]
constexpr double sample_step = 2 * pi / samples;

// Positions between two maps at which the error is evaluated: evenly for smooth lobes (16 positions miss the peak of a
// parabola by at most 0.4 %), and next to the ends, where the error of a lobe with a jump (p near 0) is largest.
constexpr std::array<double, 17> positions{0.001,  0.0625, 0.125,  0.1875, 0.25,   0.3125, 0.375,  0.4375, 0.5,
                                           0.5625, 0.625,  0.6875, 0.75,   0.8125, 0.875,  0.9375, 0.999};

// The error of interpolating the kernel of one light, as a function of the sum theta + theta'_m of the angles: the
// largest over the positions between two maps.
std::vector<double> worst_error_by_sum(const ZonalKernels& kernels, double spacing) {
    const auto specular = [&](double theta_light, double theta_view) {
        return kernels.kernel(specular_lobe, theta_light, theta_view);
    };
    std::vector<double> worst(samples + 1);
    parallel_for(worst.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const double sum = double(i) * sample_step;
            const double low = specular(sum, 0), high = specular(sum, spacing);
            for (const double f : positions) {
                const double truth = specular(sum, f * spacing);
                worst[i] = std::max(worst[i], std::abs((1 - f) * low + f * high - truth));
            }
        }
    });
    return worst;
}

// Running maximum over +-reach (radians).
std::vector<double> widened(const std::vector<double>& values, double reach) {
    const int width = static_cast<int>(std::ceil(reach / sample_step)) + 1, count = static_cast<int>(values.size());
    std::vector<double> result(values.size());
    for (int i = 0; i < count; ++i)
        result[i] =
            *std::max_element(values.begin() + std::max(0, i - width), values.begin() + std::min(count, i + width + 1));
    return result;
}

std::vector<Vec3d> half_of_the_cube() {
    std::vector<Vec3d> tangents;
    for (const int face : {0, 2, 4})
        for (int row = 0; row < tangent_size; ++row)
            for (int column = 0; column < tangent_size; ++column)
                tangents.push_back(cube_texel_direction(tangent_size, face, row, column));
    return tangents;
}

}  // namespace

double texel_radius(int face_size) { return std::numbers::sqrt2 / face_size; }

void add_interpolation_rows(KernelTable& table, const ZonalKernels& kernels, int specular_maps, double radius) {
    const double spacing = pi / (specular_maps - 1);
    std::vector<double> worst = widened(worst_error_by_sum(kernels, spacing), radius + table.grid().largest_step());
    for (double& value : worst) value *= 1.02;
    for (int m = 0; m + 1 < specular_maps; ++m)
        table.add_row([&](double theta) { return worst[std::lround((theta + m * spacing) / sample_step)]; });
}

Vec3d interpolation_bound(const LightSet& lights, const ZonalKernels& kernels, int specular_maps,
                          const Progress& progress) {
    KernelTable table(AngleGrid(1024));
    add_interpolation_rows(table, kernels, specular_maps, texel_radius(tangent_size) + lights.radius);
    Vec3d bound;
    for (const Vec3f& sum : sum_kernels(lights, half_of_the_cube(), table, progress))
        for (int channel = 0; channel < 3; ++channel) bound[channel] = std::max(bound[channel], double(sum[channel]));
    return bound;
}

}  // namespace hairbake
