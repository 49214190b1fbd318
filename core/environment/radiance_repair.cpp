#include "core/environment/radiance_repair.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>

#include "core/base/parallel.h"

namespace hairbake {
namespace {

struct RowFacts {
    int first_invalid = -1;  // column
    float largest_finite = 0;
    RadianceRepairs repairs;
};

constexpr double most_invalid = 0.01;  // share that the policy automatic repairs

bool valid(float value) { return value >= 0 && std::isfinite(value); }

RowFacts inspect(const Vec3f* row, int width) {
    RowFacts facts;
    for (int x = 0; x < width; ++x) {
        bool negative = false, nan = false, infinite = false;
        for (int channel = 0; channel < 3; ++channel) {
            const float value = row[x][channel];
            if (valid(value)) {
                facts.largest_finite = std::max(facts.largest_finite, value);
                continue;
            }
            nan |= std::isnan(value);
            infinite |= std::isinf(value);
            negative |= value < 0 && std::isfinite(value);
        }
        facts.repairs.nan_pixels += nan;
        facts.repairs.infinite_pixels += infinite;
        facts.repairs.negative_pixels += negative;
        if ((nan || infinite || negative) && facts.first_invalid < 0) facts.first_invalid = x;
    }
    return facts;
}

void clamp_row(Vec3f* row, const TexelSolidAngles& solid_angles, int y, float largest, RadianceRepairs& repairs) {
    const double* share = solid_angles.texels_of_row(y);
    double removed = 0, total = 0;
    double unknown = 0;
    for (int x = 0; x < solid_angles.width; ++x) {
        if (!is_finite(row[x])) unknown += share[x];
        for (int channel = 0; channel < 3; ++channel) {
            float& value = row[x][channel];
            if (!valid(value)) {
                if (value < 0 && std::isfinite(value)) removed -= value * share[x];
                value = value > 0 ? largest : 0;  // +infinity; all others are 0
            }
            total += value * share[x];
        }
    }
    repairs.solid_angle += unknown * solid_angles.row[y];
    repairs.energy_removed += removed * solid_angles.row[y];
    repairs.energy_total += total * solid_angles.row[y];
}

/// The first invalid pixel: its place in the map, and its values before the repair.
struct InvalidPixel {
    std::size_t index = 0;
    Vec3f values;
};

std::string describe(const EnvironmentMap& map, const InvalidPixel& pixel) {
    constexpr const char* names[] = {"red", "green", "blue"};
    int channel = 0;
    while (valid(pixel.values[channel])) ++channel;
    std::ostringstream text;
    text << "the " << names[channel] << " radiance at " << place_of_texel(map, pixel.index) << " is "
         << pixel.values[channel];
    return text.str();
}

[[noreturn]] void refuse(const std::string& text) {
    throw Error(ErrorKind::bad_input,
                text + ". environment_settings.invalid_radiance = clamp repairs and counts any number of such pixels",
                "environment_settings.invalid_radiance");
}

[[noreturn]] void refuse_share(const EnvironmentMap& map, const RadianceRepairs& repairs, const InvalidPixel& first,
                               const std::string& where) {
    std::ostringstream text;
    const std::uint64_t unknown = repairs.nan_pixels + repairs.infinite_pixels;
    text << where << ": " << repairs.negative_pixels << " pixels have negative radiance and " << unknown
         << " infinite or NaN radiance, together " << 100 * invalid_share(repairs)
         << " % of the light or of the sphere; allowed is up to " << 100 * most_invalid
         << " %. The first: " << describe(map, first);
    refuse(text.str());
}

void add(RadianceRepairs& sum, const RadianceRepairs& row) {
    sum.negative_pixels += row.negative_pixels;
    sum.nan_pixels += row.nan_pixels;
    sum.infinite_pixels += row.infinite_pixels;
    sum.solid_angle += row.solid_angle;
    sum.energy_removed += row.energy_removed;
    sum.energy_total += row.energy_total;
}

}  // namespace

double invalid_share(const RadianceRepairs& repairs) {
    const double of_sphere = repairs.solid_angle / (4 * std::numbers::pi);
    if (repairs.energy_removed == 0) return of_sphere;
    return of_sphere + repairs.energy_removed / repairs.energy_total;
}

RadianceRepairs repair_radiance(EnvironmentMap& map, InvalidRadiance policy, const std::string& where,
                                const Progress& progress) {
    std::vector<RowFacts> facts(map.height);
    parallel_for(map.height, 16, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t y = begin; y < end; ++y) facts[y] = inspect(map.pixels.data() + y * map.width, map.width);
    });
    float largest = 0;
    std::optional<InvalidPixel> first;
    for (int y = 0; y < map.height; ++y) {
        largest = std::max(largest, facts[y].largest_finite);
        if (first || facts[y].first_invalid < 0) continue;
        const std::size_t index = std::size_t(y) * map.width + facts[y].first_invalid;
        first = InvalidPixel{index, map.pixels[index]};
    }
    if (first && policy == InvalidRadiance::reject)
        refuse(where + ": " + describe(map, *first) + "; allowed is finite and not negative");
    const TexelSolidAngles solid_angles = texel_solid_angles(map);
    parallel_for(map.height, 16, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t y = begin; y < end; ++y)
            clamp_row(map.pixels.data() + y * map.width, solid_angles, int(y), largest, facts[y].repairs);
    });
    RadianceRepairs repairs;
    for (const RowFacts& row : facts) add(repairs, row.repairs);
    if (first && policy == InvalidRadiance::automatic && invalid_share(repairs) > most_invalid)
        refuse_share(map, repairs, *first, where);
    return repairs;
}

}  // namespace hairbake
