#include "core/environment/environment_reader.h"

#include <cmath>
#include <sstream>

#include "core/base/parallel.h"
#include "core/environment/image_file.h"
#include "core/environment/radiance_repair.h"

namespace hairbake {
namespace {

void check_settings(const EnvironmentSettings& settings) {
    const auto refuse = [](const std::string& field, const std::string& found, const std::string& allowed) {
        throw Error(ErrorKind::usage, "irradiance." + field + " is " + found + "; allowed is " + allowed,
                    "irradiance." + field);
    };
    if (settings.layout != "auto" && settings.layout != "latlong")
        refuse("layout", '"' + settings.layout + '"', "\"auto\" or \"latlong\"");
    for (const double angle : settings.rotation_deg)
        if (!std::isfinite(angle)) refuse("rotation_deg", std::to_string(angle), "finite");
    if (!(std::abs(settings.exposure_stops) <= 64))
        refuse("exposure_stops", std::to_string(settings.exposure_stops), "-64 to 64");
    for (const double factor : settings.tint)
        if (!(factor >= 0) || !std::isfinite(factor)) refuse("tint", std::to_string(factor), "finite and not negative");
}

// IEC 61966-2-1.
float srgb_to_linear(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

void linearize(EnvironmentMap& map, const Progress& progress) {
    map.low_dynamic_range = true;
    map.warnings.push_back("the image holds integers: decoded as sRGB, its dynamic range is low and lamps are clipped");
    parallel_for(map.height, 16, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t i = begin * map.width; i < end * map.width; ++i) {
            Vec3f& p = map.pixels[i];
            p = {srgb_to_linear(p.x), srgb_to_linear(p.y), srgb_to_linear(p.z)};
        }
    });
}

// Names the first pixel that left the range of single precision.
[[noreturn]] void refuse_overflow(const EnvironmentMap& map, const std::string& file) {
    std::size_t i = 0;
    while (is_finite(map.pixels[i])) ++i;
    std::ostringstream text;
    text << file << ": exposure and tint take the radiance at pixel (" << i % map.width << ", " << i / map.width
         << ") beyond the range of single precision (3.4e38); lower irradiance.exposure_stops";
    throw Error(ErrorKind::usage, text.str(), "irradiance.exposure_stops");
}

// After the repair, so that what is named in an error is what the file holds.
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

}  // namespace

EnvironmentMap read_environment(const std::filesystem::path& file, const EnvironmentSettings& settings,
                                Progress& progress) {
    check_settings(settings);
    progress.report("read_environment", 0);
    ImageFile image = read_image_file(file, progress);
    EnvironmentMap map;
    map.width = image.width;
    map.height = image.height;
    map.pixels = std::move(image.pixels);
    map.latlong = settings.latlong;
    map.rotation = rotation_matrix(settings.rotation_deg);
    map.source_format = image.format;
    map.primaries = image.primaries;
    map.warnings = std::move(image.warnings);

    if (image.integer) linearize(map, progress);
    repair_radiance(map, settings.invalid_radiance, file.string(), progress);
    if (map.repairs.energy_removed > 0) {
        std::ostringstream text;
        text << map.repairs.negative_pixels << " pixels with negative radiance were set to 0, "
             << 100 * map.repairs.energy_removed / map.repairs.energy_total << " % of the light";
        map.warnings.push_back(text.str());
    }
    expose(map, settings, file.string(), progress);
    progress.report("read_environment", 1);
    return map;
}

}  // namespace hairbake
