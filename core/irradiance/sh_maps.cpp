#include "core/irradiance/sh_maps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/base/spherical_harmonics.h"
#include "core/environment/cube_map.h"
#include "core/environment/sh_projection.h"
#include "core/environment/sh_rotation.h"
#include "core/fiber/kajiya_kay.h"

namespace hairbake {

using std::numbers::pi;

namespace {

constexpr int most_bands = 128;
constexpr int most_reported_bands = 32;  // turning coefficients costs bands^4
constexpr double sampling_margin = 1.1;

// The kernels of one group of maps (the diffuse one, or all specular ones) by band.
struct Kernels {
    std::vector<std::vector<double>> lambda;  // [maps][most_bands]
    std::vector<double> mean_square;          // mean over maps of lambda_l^2
    double mean_energy = 0;                   // mean over maps of the integral of the squared kernel

    void add(std::vector<double> zonal, double energy) {
        lambda.push_back(std::move(zonal));
        mean_energy += energy;
    }
    void finish() {
        mean_energy /= double(lambda.size());
        mean_square.assign(most_bands, 0);
        for (const auto& row : lambda)
            for (int l = 0; l < most_bands; ++l) mean_square[l] += row[l] * row[l] / double(lambda.size());
    }
    // Energy that `bands` bands leave out; never below zero, where only rounding is left.
    double energy_beyond(int bands) const {
        double energy = mean_energy;
        for (int l = 0; l < bands; ++l) energy -= mean_square[l] * (2 * l + 1) / (4 * pi);
        return std::max(energy, 0.0);
    }
};

Kernels diffuse_kernels() {
    Kernels kernels;
    kernels.add(diffuse_zonal(most_bands), diffuse_energy());
    kernels.finish();
    return kernels;
}

Kernels specular_kernels(double exponent, int maps) {
    Kernels kernels;
    kernels.lambda.resize(maps);
    std::vector<double> energies(maps);
    parallel_for(maps, 1, [&](std::size_t m, std::size_t) {
        const double theta_view = pi * double(m) / (maps - 1);
        kernels.lambda[m] = specular_zonal(most_bands, exponent, theta_view);
        energies[m] = specular_energy(exponent, theta_view);
    });
    for (const double energy : energies) kernels.mean_energy += energy;
    kernels.finish();
    return kernels;
}

// Bands to project: what lies beyond must be below a quarter of the target for any environment. The largest value of
// all maps is at least the diffuse map's mean, flux * pi / 4.
int bands_to_project(const Kernels& kernels, double target) {
    for (int bands = 1; bands < most_bands; ++bands)
        if (std::sqrt(kernels.energy_beyond(bands) / (4 * pi)) / (pi / 4) <= target / 4) return bands;
    return most_bands;
}

// The environment in the map's polar frame.
struct Environment {
    std::vector<Vec3d> coefficients;  // [bands * bands]
    int bands = 0;
    std::vector<double> power;  // [bands], mean over channels
    double flux_square = 0;     // mean over channels

    Environment(std::vector<Vec3d> c, int n) : coefficients(std::move(c)), bands(n), power(n) {
        for (int l = 0; l < bands; ++l)
            for (int i = l * l; i < (l + 1) * (l + 1); ++i) power[l] += dot(coefficients[i], coefficients[i]) / 3;
        flux_square = 4 * pi * dot(coefficients[0], coefficients[0]) / 3;
    }
};

double truncation_rms(const Kernels& kernels, const Environment& environment, int bands) {
    double square = environment.flux_square * kernels.energy_beyond(environment.bands);
    for (int l = bands; l < environment.bands; ++l) square += kernels.mean_square[l] * environment.power[l];
    return sampling_margin * std::sqrt(square / (4 * pi));
}

int choose_bands(const Kernels& kernels, const Environment& environment, double allowed_rms) {
    for (int bands = 1; bands < environment.bands; ++bands)
        if (truncation_rms(kernels, environment, bands) <= allowed_rms) return bands;
    return environment.bands;
}

// Sums over m of c_lm Y_lm(t), one per band: every map follows from them.
void band_values(const Environment& environment, const ShBasis& basis, const Vec3d& t, std::vector<double>& y,
                 std::vector<Vec3d>& values) {
    basis.evaluate(t, y);
    for (int l = 0; l < basis.bands(); ++l) {
        Vec3d sum;
        for (int i = l * l; i < (l + 1) * (l + 1); ++i) sum += environment.coefficients[i] * y[i];
        values[l] = sum;
    }
}

Vec3d convolve(const std::vector<double>& lambda, const std::vector<Vec3d>& values, int bands) {
    Vec3d sum;
    for (int l = 0; l < bands; ++l) sum += values[l] * lambda[l];
    return sum;
}

struct Bands {
    int diffuse, specular;
};

// Fills the maps; negative values stay.
void fill(const Kernels& diffuse, const Kernels& specular, const Environment& environment, Bands bands,
          const Matrix3& to_world, const Progress& progress, IrradianceMaps& maps) {
    const int n = maps.face_size;
    const std::size_t texels = std::size_t(cube_faces) * n * n;
    const ShBasis basis(std::max(bands.diffuse, bands.specular));
    maps.diffuse.assign(texels, {});
    maps.specular.assign(specular.lambda.size(), CubeTexels(texels));
    parallel_for(std::size_t(cube_faces) * n, 4, [&](std::size_t begin, std::size_t end) {
        progress.check();
        std::vector<double> y(basis.count());
        std::vector<Vec3d> values(basis.bands());
        for (std::size_t i = begin * n; i < end * n; ++i) {
            const Vec3d t = cube_texel_direction(n, int(i / n / n), int(i / n % n), int(i % n));
            band_values(environment, basis, transform_back(to_world, t), y, values);
            maps.diffuse[i] = Vec3f(convolve(diffuse.lambda[0], values, bands.diffuse));
            for (std::size_t m = 0; m < specular.lambda.size(); ++m)
                maps.specular[m][i] = Vec3f(convolve(specular.lambda[m], values, bands.specular));
        }
    });
}

double largest_of(const CubeTexels& texels, double largest) {
    for (const Vec3f& v : texels) largest = std::max({largest, double(v.x), double(v.y), double(v.z)});
    return largest;
}

double largest_value(const IrradianceMaps& maps) {
    double largest = largest_of(maps.diffuse, 0);
    for (const CubeTexels& texels : maps.specular) largest = largest_of(texels, largest);
    return largest;
}

// The largest value of all maps with every projected band, on a grid of its own so that it does not depend on
// face_size.
double estimate_largest(const Kernels& diffuse, const Kernels& specular, const Environment& environment,
                        const Matrix3& to_world, const Progress& progress) {
    IrradianceMaps probe;
    probe.face_size = 16;
    fill(diffuse, specular, environment, {environment.bands, environment.bands}, to_world, progress, probe);
    return largest_value(probe);
}

double remove_negative(CubeTexels& texels, const std::vector<double>& solid_angles, bool clamp) {
    double mass = 0;
    for (std::size_t i = 0; i < texels.size(); ++i)
        for (int channel = 0; channel < 3; ++channel) {
            float& value = texels[i][channel];
            if (!(value < 0)) continue;
            mass -= double(value) * solid_angles[i % solid_angles.size()];
            if (clamp) value = 0;
        }
    return mass;
}

}  // namespace

void bake_sh_maps(const EnvironmentMap& map, const IrradianceSettings& settings, int report_bands,
                  const Progress& progress, IrradianceMaps& maps) {
    const Kernels diffuse = diffuse_kernels(), specular = specular_kernels(settings.exponent, settings.specular_maps);
    const int projected =
        std::max({bands_to_project(diffuse, settings.sh_error), bands_to_project(specular, settings.sh_error),
                  report_bands, settings.sh_bands_diffuse.value_or(1), settings.sh_bands_specular.value_or(1)});
    const Environment environment(project_sh(map, projected, progress), projected);
    const Matrix3 to_world = map_to_world(map);

    const double allowed = settings.sh_error * estimate_largest(diffuse, specular, environment, to_world, progress);
    maps.sh_bands_diffuse = settings.sh_bands_diffuse.value_or(choose_bands(diffuse, environment, allowed));
    maps.sh_bands_specular = settings.sh_bands_specular.value_or(choose_bands(specular, environment, allowed));
    fill(diffuse, specular, environment, {maps.sh_bands_diffuse, maps.sh_bands_specular}, to_world, progress, maps);

    const double largest = largest_value(maps);
    const auto relative = [&](double rms) { return largest > 0 ? rms / largest : 0; };
    maps.predicted_error_diffuse = relative(truncation_rms(diffuse, environment, maps.sh_bands_diffuse));
    maps.predicted_error_specular = relative(truncation_rms(specular, environment, maps.sh_bands_specular));

    const std::vector<double> solid_angles = cube_texel_solid_angles(maps.face_size);
    maps.diffuse_statistics.clamped_negative_mass =
        remove_negative(maps.diffuse, solid_angles, settings.clamp_negative);
    for (std::size_t m = 0; m < maps.specular.size(); ++m)
        maps.specular_statistics[m].clamped_negative_mass =
            remove_negative(maps.specular[m], solid_angles, settings.clamp_negative);

    const int used = std::max(maps.sh_bands_diffuse, maps.sh_bands_specular);
    maps.environment_sh_bands = std::max(report_bands, std::min(used, most_reported_bands));
    const std::size_t count = std::size_t(maps.environment_sh_bands) * maps.environment_sh_bands;
    maps.environment_sh =
        rotate_sh(std::span(environment.coefficients).first(count), maps.environment_sh_bands, to_world);
}

}  // namespace hairbake
