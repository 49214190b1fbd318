#include "core/environment/environment_reader.h"

#include <cmath>
#include <sstream>

#include "core/base/parallel.h"
#include "core/base/short_number.h"
#include "core/environment/environment_assembly.h"
#include "core/environment/environment_files.h"
#include "core/environment/radiance_repair.h"

namespace hairbake {
namespace {

void check_settings(const EnvironmentSettings& settings) {
    const auto refuse = [](const std::string& field, const std::string& found, const std::string& allowed) {
        throw Error(ErrorKind::usage, "environment_settings." + field + " is " + found + "; allowed is " + allowed,
                    "environment_settings." + field);
    };
    for (const double angle : settings.rotation_deg)
        if (!std::isfinite(angle)) refuse("rotation_deg", short_number(angle), "finite");
    if (!(std::abs(settings.exposure_stops) <= 64))
        refuse("exposure_stops", short_number(settings.exposure_stops), "-64 to 64");
    for (const double factor : settings.tint)
        if (!(factor >= 0) || !std::isfinite(factor)) refuse("tint", short_number(factor), "finite and not negative");
}

// Names the first pixel that left the range of single precision.
[[noreturn]] void refuse_overflow(const EnvironmentMap& map, const std::string& file) {
    std::size_t i = 0;
    while (is_finite(map.pixels[i])) ++i;
    std::ostringstream text;
    text << file << ": exposure and tint take the radiance at " << place_of_texel(map, i)
         << " beyond the range of single precision (3.4e38); lower environment_settings.exposure_stops";
    throw Error(ErrorKind::usage, text.str(), "environment_settings.exposure_stops");
}

// Applies exposure and tint. It runs after the repair, so that an error of the repair names the file's own values.
void expose(EnvironmentMap& map, const EnvironmentSettings& settings, const std::string& file,
            const Progress& progress) {
    const double gain = std::exp2(settings.exposure_stops);
    const Vec3f factor{Vec3d{settings.tint[0], settings.tint[1], settings.tint[2]} * gain};
    if (factor == Vec3f(1)) return;
    std::vector<std::uint8_t> overflow(map.height, 0);
    parallel_for(map.height, 16, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t i = begin * map.width; i < end * map.width; ++i) {
            map.pixels[i] = map.pixels[i] * factor;
            if (!is_finite(map.pixels[i])) overflow[i / map.width] = 1;
        }
    });
    for (const std::uint8_t row : overflow)
        if (row) refuse_overflow(map, file);
}

/// Counts of the repaired pixels by kind; empty where all were valid, and where the policy automatic removed less than
/// a millionth of the light: nearly every sky made by a program has a few negative pixels of rounding.
std::string repair_warning(const RadianceRepairs& done, InvalidRadiance policy) {
    constexpr double noticeable = 1e-6;
    if (policy == InvalidRadiance::automatic && done.nan_pixels + done.infinite_pixels == 0 &&
        invalid_share(done) <= noticeable)
        return {};
    std::ostringstream text;
    const auto add = [&](std::uint64_t pixels, const char* radiance, const char* became) {
        if (pixels == 0) return;
        text << (text.tellp() > 0 ? "; " : "") << pixels << (pixels == 1 ? " pixel" : " pixels") << " with " << radiance
             << " radiance " << (pixels == 1 ? "was" : "were") << " set to " << became;
    };
    add(done.negative_pixels, "negative", "0");
    if (done.energy_removed > 0 && done.energy_total > 0)
        text << ", " << 100 * done.energy_removed / done.energy_total << " % of the light";
    add(done.nan_pixels, "NaN", "0");
    add(done.infinite_pixels, "infinite", "the largest finite value (-infinity to 0)");
    return text.str();
}

/// The convention of a lat-long map's columns; a cube has none.
void take_convention(EnvironmentMap& map, LatLong convention) {
    if (convention == LatLong::automatic) return;
    map.latlong = convention;
    if (map.shape == EnvironmentShape::cube && convention != LatLong::gltf)
        map.warnings.push_back("environment_settings.latlong is " + std::string(name_of(convention)) +
                               ", but the environment is a cube map: it was not used");
}

/// Converts to the primaries that were asked for. Colours outside them come out negative; these are invalid radiance.
void convert_primaries(EnvironmentMap& map, const EnvironmentSettings& settings, const std::string& file,
                       const Progress& progress) {
    const std::optional<Chromaticities> target = chromaticities_of(settings.to_primaries);
    if (!target) return;
    if (!map.primaries.xy)
        map.warnings.push_back("the file names no primaries: they were taken as Rec.709 and converted to " +
                               name_of(*target));
    const Chromaticities source = map.primaries.xy.value_or(default_chromaticities());
    map.primaries = {name_of(*target), target};
    if (source == *target) return;
    const Matrix3 matrix = rgb_conversion(source, *target);
    parallel_for(map.pixels.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t i = begin; i < end; ++i) map.pixels[i] = Vec3f(transform(matrix, Vec3d(map.pixels[i])));
    });
    const RadianceRepairs outside =
        repair_radiance(map, settings.invalid_radiance, file + ", converted to " + map.primaries.name, progress);
    if (const std::string warning = repair_warning(outside, settings.invalid_radiance); !warning.empty())
        map.warnings.push_back("colours outside " + map.primaries.name + ": " + warning);
    map.repairs.energy_total = outside.energy_total;
}

}  // namespace

EnvironmentMap read_environment(const std::filesystem::path& path, const EnvironmentSettings& settings,
                                Progress& progress) {
    check_settings(settings);
    EnvironmentMap map = assemble_environment(find_environment_files(path), settings.layout, progress);
    take_convention(map, settings.latlong);
    map.rotation = rotation_matrix(settings.rotation_deg);
    map.repairs = repair_radiance(map, settings.invalid_radiance, path.string(), progress);
    if (std::string warning = repair_warning(map.repairs, settings.invalid_radiance); !warning.empty())
        map.warnings.push_back(std::move(warning));
    convert_primaries(map, settings, path.string(), progress);
    expose(map, settings, path.string(), progress);
    progress.report(1);
    return map;
}

void check_environment(const std::filesystem::path& path, const EnvironmentSettings& settings) {
    check_settings(settings);
    check_pictures(find_environment_files(path), settings.layout);
}

}  // namespace hairbake
