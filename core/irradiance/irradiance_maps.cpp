#include "core/irradiance/irradiance_maps.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "core/base/short_number.h"
#include "core/environment/light_set.h"
#include "core/environment/sh_projection.h"
#include "core/environment/sh_rotation.h"
#include "core/fiber/fiber_model.h"
#include "core/irradiance/added_lights.h"
#include "core/irradiance/exact_maps.h"
#include "core/irradiance/interpolation_bound.h"
#include "core/irradiance/sh_maps.h"

namespace hairbake {

using std::numbers::pi;

namespace {

constexpr int reported_bands = 8;
constexpr int bound_resolution = 32;  // of the lights over which the method sh sums its bound

/// The result with these texels.
IrradianceMaps result_of(TangentMaps baked) {
    IrradianceMaps maps;
    maps.face_size = baked.face_size;
    maps.diffuse = std::move(baked.diffuse);
    maps.specular = std::move(baked.specular);
    maps.specular_statistics.resize(maps.specular.size());
    return maps;
}

/// The maps of the environment alone by the method exact.
IrradianceMaps bake_exact(const EnvironmentMap& environment, const IrradianceSettings& settings,
                          const FiberModel& model, Progress& progress) {
    const LightSet lights = make_light_set(environment, light_resolution(model.sharpness()), progress);
    progress.report(0.2);
    ProgressPart summing = progress.part(0.2, 0.8);
    ExactMaps exact = bake_exact_maps(lights, settings, model, summing);
    IrradianceMaps maps = result_of(std::move(exact.maps));
    maps.interpolation_bound = exact.interpolation_bound;
    maps.environment_sh_bands = reported_bands;
    maps.environment_sh =
        rotate_sh(project_sh(environment, reported_bands, progress), reported_bands, map_to_world(environment));
    return maps;
}

/// The maps of the environment alone by the method sh.
IrradianceMaps bake_sh(const EnvironmentMap& environment, const IrradianceSettings& settings,
                       const ZonalKernels& kernels, Progress& progress) {
    const LightSet lights = make_light_set(environment, bound_resolution, progress);
    progress.report(0.2);
    const Vec3d bound = interpolation_bound(with_directional_lights(lights, settings.lights), kernels,
                                            settings.specular_maps, progress);
    ShMaps sh = bake_sh_maps(environment, settings, kernels, reported_bands, progress);
    IrradianceMaps maps = result_of(std::move(sh.maps));
    maps.interpolation_bound = bound;
    maps.diffuse_statistics.clamped_negative_mass = sh.negative_mass_diffuse;
    for (std::size_t m = 0; m < maps.specular.size(); ++m)
        maps.specular_statistics[m].clamped_negative_mass = sh.negative_mass_specular[m];
    maps.sh_bands_diffuse = sh.bands_diffuse;
    maps.sh_bands_specular = sh.bands_specular;
    maps.predicted_error_diffuse = sh.predicted_error_diffuse;
    maps.predicted_error_specular = sh.predicted_error_specular;
    maps.environment_sh = std::move(sh.environment);
    maps.environment_sh_bands = sh.environment_bands;
    return maps;
}

/// Mean, minimum and maximum; `clamped_negative_mass` is passed on.
MapStatistics measured(const CubeTexels& texels, const std::vector<double>& solid_angles,
                       double clamped_negative_mass) {
    MapStatistics statistics{{}, texels.front(), texels.front(), clamped_negative_mass};
    Vec3d sum;
    for (std::size_t i = 0; i < texels.size(); ++i) {
        sum += Vec3d(texels[i]) * solid_angles[i % solid_angles.size()];
        if (!is_finite(texels[i]))
            throw Error(ErrorKind::bad_input,
                        "the environment is so bright that a map leaves the range of single precision (3.4e38); lower "
                        "environment_settings.exposure_stops or irradiance.lights",
                        "environment_settings.exposure_stops");
        for (int channel = 0; channel < 3; ++channel) {
            statistics.minimum[channel] = std::min(statistics.minimum[channel], texels[i][channel]);
            statistics.maximum[channel] = std::max(statistics.maximum[channel], texels[i][channel]);
        }
    }
    statistics.mean = sum / (4 * pi);
    return statistics;
}

double largest(const Vec3f& v) { return std::max({v.x, v.y, v.z}); }

/// Fills the statistics of the texels as they are now, and the relative bound.
void measure_all(IrradianceMaps& maps) {
    const std::vector<double> solid_angles = cube_texel_solid_angles(maps.face_size);
    const auto measure = [&](const CubeTexels& texels, MapStatistics& statistics) {
        statistics = measured(texels, solid_angles, statistics.clamped_negative_mass);
        return largest(statistics.maximum);
    };
    measure(maps.diffuse, maps.diffuse_statistics);
    double peak = 0;
    for (std::size_t m = 0; m < maps.specular.size(); ++m)
        peak = std::max(peak, measure(maps.specular[m], maps.specular_statistics[m]));
    const Vec3d& bound = maps.interpolation_bound;
    maps.interpolation_bound_relative = peak > 0 ? std::max({bound.x, bound.y, bound.z}) / peak : 0;
}

std::string degrees(double radians) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g degrees", radians * 180 / pi);
    return text;
}

std::string percent(double ratio) {
    char text[32];
    std::snprintf(text, sizeof text, ratio < 1 ? "%.2g %%" : "%.0f %%", 100 * ratio);
    return text;
}

std::vector<std::string> warnings_of(const IrradianceMaps& maps, const IrradianceSettings& settings,
                                     double half_width) {
    std::vector<std::string> warnings;
    const double texel = 2.0 / settings.face_size;
    if (texel > half_width)
        warnings.push_back("a texel of the maps (" + degrees(texel) +
                           ") is wider than the half-width of the specular lobe (" + degrees(half_width) +
                           "): small lights will look blocky; raise irradiance.face_size");
    const double predicted = std::max(maps.predicted_error_diffuse, maps.predicted_error_specular);
    const bool automatic = !settings.sh_bands_diffuse || !settings.sh_bands_specular;
    if (settings.method == IrradianceMethod::sh && predicted > settings.sh_error)
        warnings.push_back("the predicted error of " + percent(predicted) + " is above irradiance.sh_error (" +
                           percent(settings.sh_error) + ")" +
                           (automatic ? ": 128 bands are the most; use irradiance.method exact" : ""));
    if (maps.interpolation_bound_relative > 0.2)
        warnings.push_back("interpolating between " + std::to_string(settings.specular_maps) +
                           " specular maps can be wrong by up to " + percent(maps.interpolation_bound_relative) +
                           " of their largest value; raise irradiance.specular_maps");
    return warnings;
}

void expect(bool ok, const std::string& field, const std::string& found, const std::string& allowed) {
    if (!ok)
        throw Error(ErrorKind::usage, "irradiance." + field + " is " + found + "; allowed is " + allowed,
                    "irradiance." + field);
}

}  // namespace

int light_resolution(double sharpness) {
    return std::clamp(static_cast<int>(std::ceil(8 * std::sqrt(sharpness))), 64, 512);
}

void validate(const IrradianceSettings& s) {
    const auto in = [](auto value, auto low, auto high) { return value >= low && value <= high; };
    expect(in(s.face_size, 4, 256), "face_size", std::to_string(s.face_size), "4 to 256");
    expect(in(s.specular_maps, 2, 257), "specular_maps", std::to_string(s.specular_maps), "2 to 257");
    expect(s.sh_error > 0 && s.sh_error <= 1, "sh_error", short_number(s.sh_error), "above 0, up to 1");
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
                               const FiberSettings& fiber, Progress& progress) {
    validate(settings);
    const std::unique_ptr<const FiberModel> model = make_fiber_model(fiber);
    const ZonalKernels& kernels = zonal_kernels_for_maps(*model, fiber);
    IrradianceMaps maps = settings.method == IrradianceMethod::exact
                              ? bake_exact(environment, settings, *model, progress)
                              : bake_sh(environment, settings, kernels, progress);
    maps.exponent = fiber.kajiya_kay.exponent;
    add_directional_lights(settings.lights, kernels, progress, maps);
    measure_all(maps);
    maps.warnings = warnings_of(maps, settings, kernels.half_width());
    progress.report(1);
    return maps;
}

}  // namespace hairbake
