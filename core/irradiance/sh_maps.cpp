#include "core/irradiance/sh_maps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/base/spherical_harmonics.h"
#include "core/environment/cube_map.h"
#include "core/environment/sh_projection.h"
#include "core/environment/sh_rotation.h"

namespace hairbake {

using std::numbers::pi;

namespace {

constexpr int most_bands = 128;
constexpr int most_reported_bands = 32;  // rotating coefficients costs bands^4
constexpr double sampling_margin = 1.1;

// The kernels of one lobe by band: of the diffuse map, or of all specular maps.
struct Kernels {
    std::vector<std::vector<double>> lambda;  // [maps][most_bands]
    std::vector<double> mean_square;          // mean over maps of lambda_l^2
    double mean_energy = 0;                   // mean over maps of the integral of the squared kernel

    void finish() {
        mean_energy /= double(lambda.size());
        mean_square.assign(most_bands, 0);
        for (const auto& row : lambda)
            for (int l = 0; l < most_bands; ++l) mean_square[l] += row[l] * row[l] / double(lambda.size());
    }
    // Energy that `bands` bands leave out, at least zero: rounding can take the difference below.
    double energy_beyond(int bands) const {
        double energy = mean_energy;
        for (int l = 0; l < bands; ++l) energy -= mean_square[l] * (2 * l + 1) / (4 * pi);
        return std::max(energy, 0.0);
    }
};

// The kernels of `lobe` at the view angles of `maps` maps.
Kernels kernels_of(const ZonalKernels& zonal, int lobe, int maps) {
    Kernels kernels;
    kernels.lambda.resize(maps);
    std::vector<double> energies(maps);
    parallel_for(maps, 1, [&](std::size_t m, std::size_t) {
        const double theta_view = maps > 1 ? view_angle(m, maps) : 0;
        kernels.lambda[m] = zonal.coefficients(lobe, most_bands, theta_view);
        energies[m] = zonal.energy(lobe, theta_view);
    });
    for (const double energy : energies) kernels.mean_energy += energy;
    kernels.finish();
    return kernels;
}

// Bands to project: the error of leaving out all others must be below a quarter of the target for any environment. The
// largest value of the lobe's maps is at least the mean of each of them, which is lambda_0 / (4 pi) times the flux.
int bands_to_project(const Kernels& kernels, double target) {
    double mean = 0;
    for (const std::vector<double>& row : kernels.lambda) mean = std::max(mean, row[0] / (4 * pi));
    for (int bands = 1; bands < most_bands; ++bands)
        if (std::sqrt(kernels.energy_beyond(bands) / (4 * pi)) <= mean * target / 4) return bands;
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

struct KernelPair {
    Kernels diffuse, specular;
};

struct Bands {
    int diffuse, specular;
};

// The maps with these bands; negative values stay.
TangentMaps make_maps(const KernelPair& kernels, const Environment& environment, Bands bands, const Matrix3& to_world,
                      int face_size, const Progress& progress) {
    const int n = face_size;
    const ShBasis basis(std::max(bands.diffuse, bands.specular));
    TangentMaps maps(n, kernels.specular.lambda.size());
    parallel_for(std::size_t(cube_faces) * n, 4, [&](std::size_t begin, std::size_t end) {
        progress.check();
        std::vector<double> y(basis.count());
        std::vector<Vec3d> values(basis.bands());
        for (std::size_t i = begin * n; i < end * n; ++i) {
            const Vec3d t = cube_texel_direction(n, int(i / n / n), int(i / n % n), int(i % n));
            band_values(environment, basis, transform_back(to_world, t), y, values);
            maps.diffuse[i] = Vec3f(convolve(kernels.diffuse.lambda[0], values, bands.diffuse));
            for (std::size_t m = 0; m < maps.specular.size(); ++m)
                maps.specular[m][i] = Vec3f(convolve(kernels.specular.lambda[m], values, bands.specular));
        }
    });
    return maps;
}

// Errors of a map are relative to the largest value of the maps of its lobe: a sky's specular maps can be three times
// darker than its diffuse map.
struct Largest {
    double diffuse = 0, specular = 0;
};

double largest_of(const CubeTexels& texels, double largest) {
    for (const Vec3f& v : texels) largest = std::max({largest, double(v.x), double(v.y), double(v.z)});
    return largest;
}

// The largest values with every projected band, on a grid of its own: they depend neither on face_size nor on the bands
// that are kept.
Largest estimate_largest(const KernelPair& kernels, const Environment& environment, const Matrix3& to_world,
                         const Progress& progress) {
    const Bands all{environment.bands, environment.bands};
    const TangentMaps maps = make_maps(kernels, environment, all, to_world, 16, progress);
    Largest largest{largest_of(maps.diffuse, 0), 0};
    for (const CubeTexels& texels : maps.specular) largest.specular = largest_of(texels, largest.specular);
    return largest;
}

// Sum of |negative| * solid angle over texels and channels; sets negative values to 0 where `clamp` says so.
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

ShMaps bake_sh_maps(const EnvironmentMap& map, const IrradianceSettings& settings, const ZonalKernels& zonal,
                    int report_bands, const Progress& progress) {
    const KernelPair kernels{kernels_of(zonal, diffuse_lobe, 1),
                             kernels_of(zonal, specular_lobe, settings.specular_maps)};
    const int projected = std::max({bands_to_project(kernels.diffuse, settings.sh_error),
                                    bands_to_project(kernels.specular, settings.sh_error), report_bands,
                                    settings.sh_bands_diffuse.value_or(1), settings.sh_bands_specular.value_or(1)});
    const Environment environment(project_sh(map, projected, progress), projected);
    const Matrix3 to_world = map_to_world(map);

    const Largest largest = estimate_largest(kernels, environment, to_world, progress);
    const auto choose = [&](const Kernels& lobe, double of) {
        return choose_bands(lobe, environment, settings.sh_error * of);
    };
    const Bands bands{settings.sh_bands_diffuse.value_or(choose(kernels.diffuse, largest.diffuse)),
                      settings.sh_bands_specular.value_or(choose(kernels.specular, largest.specular))};
    ShMaps baked(make_maps(kernels, environment, bands, to_world, settings.face_size, progress));
    baked.bands_diffuse = bands.diffuse;
    baked.bands_specular = bands.specular;

    const auto relative = [](double rms, double of) { return of > 0 ? rms / of : 0; };
    baked.predicted_error_diffuse =
        relative(truncation_rms(kernels.diffuse, environment, bands.diffuse), largest.diffuse);
    baked.predicted_error_specular =
        relative(truncation_rms(kernels.specular, environment, bands.specular), largest.specular);

    const std::vector<double> solid_angles = cube_texel_solid_angles(settings.face_size);
    baked.negative_mass_diffuse = remove_negative(baked.maps.diffuse, solid_angles, settings.clamp_negative);
    for (CubeTexels& texels : baked.maps.specular)
        baked.negative_mass_specular.push_back(remove_negative(texels, solid_angles, settings.clamp_negative));

    const int used = std::max(bands.diffuse, bands.specular);
    baked.environment_bands = std::max(report_bands, std::min(used, most_reported_bands));
    const std::size_t count = std::size_t(baked.environment_bands) * baked.environment_bands;
    baked.environment = rotate_sh(std::span(environment.coefficients).first(count), baked.environment_bands, to_world);
    return baked;
}

}  // namespace hairbake
