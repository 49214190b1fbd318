#include "core/irradiance/irradiance_maps.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>

#include "core/environment/light_set.h"
#include "core/environment/sh_projection.h"
#include "core/environment/sh_rotation.h"
#include "core/fiber/kajiya_kay.h"
#include "core/irradiance/added_lights.h"
#include "core/irradiance/interpolation_bound.h"
#include "core/irradiance/kernel_sum.h"
#include "core/irradiance/sh_maps.h"

namespace hairbake {

using std::numbers::pi;

namespace {

constexpr int reported_bands = 8;

KernelTable kajiya_kay_table(double exponent, int specular_maps) {
    KernelTable table(AngleGrid::for_exponent(exponent));
    table.add_row([](double theta) { return std::sin(theta); });
    for (int m = 0; m < specular_maps; ++m) {
        const double theta_view = pi * m / (specular_maps - 1);
        // Below 1e-12 of the peak nothing reaches single precision.
        table.add_row([&](double theta) {
            const double k = kajiya_kay_specular(theta, theta_view, exponent);
            return k < 1e-12 ? 0 : k;
        });
    }
    return table;
}

// One texel of every map and its opposite: D(-t) = D(t) and S_m(-t) = S_M-m(t).
void store_texel(const Vec3f* sums, std::size_t texel, IrradianceMaps& maps) {
    const std::size_t opposite = cube_antipode(maps.face_size, texel), last = maps.specular.size() - 1;
    maps.diffuse[texel] = maps.diffuse[opposite] = sums[0];
    for (std::size_t m = 0; m <= last; ++m) maps.specular[m][texel] = maps.specular[last - m][opposite] = sums[1 + m];
}

// The largest sum of an interpolation row over the tangents; the directional lights' share is summed by itself.
Vec3d largest_bound(std::span<const Vec3f> sums, std::span<const Vec3f> added, int rows, int first_bound) {
    Vec3d bound;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (int(i % rows) < first_bound) continue;
        const Vec3d sum = added.empty() ? Vec3d(sums[i]) : Vec3d(sums[i]) + Vec3d(added[i]);
        for (int channel = 0; channel < 3; ++channel) bound[channel] = std::max(bound[channel], sum[channel]);
    }
    return bound;
}

// Sums over the lights for the tangents of faces +X, +Y and +Z, and the bound of interpolation by the way: cubes
// coarser than 16 would make it needlessly loose and have it computed by itself.
void bake_exact_maps(const LightSet& lights, const IrradianceSettings& settings, Progress& progress,
                     IrradianceMaps& maps) {
    const int n = maps.face_size, count = settings.specular_maps;
    KernelTable table = kajiya_kay_table(settings.exponent, count);
    if (n >= 16) add_interpolation_rows(table, settings.exponent, count, texel_radius(n) + lights.radius);
    const std::size_t texels = std::size_t(n) * n;
    maps.diffuse.assign(cube_faces * texels, {});
    maps.specular.assign(count, CubeTexels(cube_faces * texels));
    std::vector<Vec3d> tangents(texels);
    const LightSet added = with_directional_lights({}, settings.lights);
    Vec3d bound;
    for (const int face : {0, 2, 4}) {
        for (std::size_t i = 0; i < texels; ++i) tangents[i] = cube_texel_direction(n, face, int(i / n), int(i % n));
        const std::vector<Vec3f> sums = sum_kernels(lights, tangents, table, progress);
        std::vector<Vec3f> added_sums;
        if (added.size() > 0) added_sums = sum_kernels(added, tangents, table, progress);
        for (std::size_t i = 0; i < texels; ++i) store_texel(sums.data() + i * table.rows(), face * texels + i, maps);
        const Vec3d here = largest_bound(sums, added_sums, table.rows(), 1 + count);
        for (int channel = 0; channel < 3; ++channel) bound[channel] = std::max(bound[channel], here[channel]);
        const int pairs_done = face / 2 + 1;
        progress.report(0.2 + 0.2 * pairs_done);
    }
    maps.interpolation_bound = n >= 16 ? bound
                                       : interpolation_bound(with_directional_lights(lights, settings.lights),
                                                             settings.exponent, count, progress);
}

void measure(const CubeTexels& texels, const std::vector<double>& solid_angles, MapStatistics& statistics) {
    statistics.minimum = statistics.maximum = texels.front();
    Vec3d sum;
    for (std::size_t i = 0; i < texels.size(); ++i) {
        sum += Vec3d(texels[i]) * solid_angles[i % solid_angles.size()];
        if (!is_finite(texels[i]))
            throw Error(ErrorKind::bad_input,
                        "the environment is so bright that a map leaves the range of single precision (3.4e38); lower "
                        "irradiance.exposure_stops or irradiance.lights",
                        "irradiance.exposure_stops");
        for (int channel = 0; channel < 3; ++channel) {
            statistics.minimum[channel] = std::min(statistics.minimum[channel], texels[i][channel]);
            statistics.maximum[channel] = std::max(statistics.maximum[channel], texels[i][channel]);
        }
    }
    statistics.mean = sum / (4 * pi);
}

double largest(const Vec3f& v) { return std::max({v.x, v.y, v.z}); }

void measure_all(IrradianceMaps& maps) {
    const std::vector<double> solid_angles = cube_texel_solid_angles(maps.face_size);
    measure(maps.diffuse, solid_angles, maps.diffuse_statistics);
    double peak = largest(maps.diffuse_statistics.maximum);
    for (std::size_t m = 0; m < maps.specular.size(); ++m) {
        measure(maps.specular[m], solid_angles, maps.specular_statistics[m]);
        peak = std::max(peak, largest(maps.specular_statistics[m].maximum));
    }
    const Vec3d& bound = maps.interpolation_bound;
    maps.interpolation_bound_relative = peak > 0 ? std::max({bound.x, bound.y, bound.z}) / peak : 0;
}

std::string percent(double ratio) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g %%", 100 * ratio);
    return text;
}

void add_warnings(const IrradianceSettings& settings, IrradianceMaps& maps) {
    // cos^p falls to one half at acos(2^(-1/p)) from its peak.
    const double half_width =
        settings.exponent > 0 ? std::acos(std::exp2(-1 / std::max(settings.exponent, 1.0))) : pi / 2;
    const double texel = 2.0 / settings.face_size;
    if (texel > half_width)
        maps.warnings.push_back("a texel of the maps (" + std::to_string(texel * 180 / pi) +
                                " degrees) is wider than the half-width of the specular lobe (" +
                                std::to_string(half_width * 180 / pi) +
                                " degrees): small lights will look blocky; raise irradiance.face_size");
    const double predicted = std::max(maps.predicted_error_diffuse, maps.predicted_error_specular);
    const bool automatic = !settings.sh_bands_diffuse || !settings.sh_bands_specular;
    if (settings.method == IrradianceMethod::sh && predicted > settings.sh_error)
        maps.warnings.push_back("the predicted error of " + percent(predicted) + " is above irradiance.sh_error (" +
                                percent(settings.sh_error) + ")" +
                                (automatic ? ": 128 bands are the most; use irradiance.method exact" : ""));
    if (maps.interpolation_bound_relative > 0.1)
        maps.warnings.push_back("interpolating between " + std::to_string(settings.specular_maps) +
                                " specular maps can be wrong by up to " + percent(maps.interpolation_bound_relative) +
                                " of the largest value; raise irradiance.specular_maps");
}

void expect(bool ok, const std::string& field, const std::string& found, const std::string& allowed) {
    if (!ok)
        throw Error(ErrorKind::usage, "irradiance." + field + " is " + found + "; allowed is " + allowed,
                    "irradiance." + field);
}

}  // namespace

int light_resolution(double exponent) {
    return std::clamp(static_cast<int>(std::ceil(8 * std::sqrt(exponent))), 64, 512);
}

void validate(const IrradianceSettings& s) {
    const auto in = [](auto value, auto low, auto high) { return value >= low && value <= high; };
    expect(s.model == "kajiya-kay", "model", '"' + s.model + '"', "\"kajiya-kay\"");
    expect(in(s.face_size, 4, 256), "face_size", std::to_string(s.face_size), "4 to 256");
    expect(in(s.specular_maps, 2, 257), "specular_maps", std::to_string(s.specular_maps), "2 to 257");
    expect(in(s.exponent, 0.0, 4096.0), "exponent", std::to_string(s.exponent), "0 to 4096");
    expect(s.sh_error > 0 && s.sh_error <= 1, "sh_error", std::to_string(s.sh_error), "above 0, up to 1");
    for (const auto& [bands, name] : {std::pair{s.sh_bands_diffuse, "diffuse"}, {s.sh_bands_specular, "specular"}})
        expect(!bands || in(*bands, 1, 128), std::string("sh_bands.") + name, std::to_string(bands.value_or(0)),
               "1 to 128, or auto");
    expect(s.lights.size() <= 64, "lights", std::to_string(s.lights.size()) + " lights", "at most 64");
    for (const DirectionalLight& light : s.lights) {
        const Vec3d& e = light.irradiance;
        const double square = dot(light.direction, light.direction);
        expect(square > 0 && std::isfinite(square), "lights", "of a direction without length",
               "a direction towards the light");
        expect(is_finite(e) && e.x >= 0 && e.y >= 0 && e.z >= 0, "lights", "of negative or infinite irradiance",
               "finite and not negative");
    }
}

IrradianceMaps bake_irradiance(const EnvironmentMap& environment, const IrradianceSettings& settings,
                               Progress& progress) {
    validate(settings);
    const bool exact = settings.method == IrradianceMethod::exact;
    IrradianceMaps maps;
    maps.face_size = settings.face_size;
    maps.exponent = settings.exponent;
    maps.specular_statistics.resize(settings.specular_maps);

    const LightSet lights = make_light_set(environment, exact ? light_resolution(settings.exponent) : 32, progress);
    progress.report(0.2);
    if (exact) {
        bake_exact_maps(lights, settings, progress, maps);
        maps.environment_sh_bands = reported_bands;
        maps.environment_sh =
            rotate_sh(project_sh(environment, reported_bands, progress), reported_bands, map_to_world(environment));
    } else {
        maps.interpolation_bound = interpolation_bound(with_directional_lights(lights, settings.lights),
                                                       settings.exponent, settings.specular_maps, progress);
        bake_sh_maps(environment, settings, reported_bands, progress, maps);
    }
    add_directional_lights(settings.lights, progress, maps);
    measure_all(maps);
    add_warnings(settings, maps);
    progress.report(1);
    return maps;
}

}  // namespace hairbake
