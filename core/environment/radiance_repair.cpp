#include "core/environment/radiance_repair.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/parallel.h"

namespace hairbake {
namespace {

struct RowFacts {
    int first_invalid = -1;  // column
    float largest_finite = 0;
    RadianceRepairs repairs;
};

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
    for (int x = 0; x < solid_angles.width; ++x)
        for (int channel = 0; channel < 3; ++channel) {
            float& value = row[x][channel];
            if (!valid(value)) {
                if (value < 0 && std::isfinite(value)) removed -= value * share[x];
                value = value > 0 ? largest : 0;  // +infinity; all others are 0
            }
            total += value * share[x];
        }
    repairs.energy_removed += removed * solid_angles.row[y];
    repairs.energy_total += total * solid_angles.row[y];
}

void refuse(const EnvironmentMap& map, std::size_t index, const std::string& where) {
    const Vec3f pixel = map.pixels[index];
    int channel = 0;
    while (valid(pixel[channel])) ++channel;
    std::ostringstream text;
    text << where << ": the "
         << (channel == 0   ? "red"
             : channel == 1 ? "green"
                            : "blue")
         << " radiance at " << place_of_texel(map, index) << " is " << pixel[channel]
         << "; allowed is finite and not negative. environment_settings.invalid_radiance = clamp repairs and counts "
            "such pixels";
    throw Error(ErrorKind::bad_input, text.str(), "environment_settings.invalid_radiance");
}

void add(RadianceRepairs& sum, const RadianceRepairs& row) {
    sum.negative_pixels += row.negative_pixels;
    sum.nan_pixels += row.nan_pixels;
    sum.infinite_pixels += row.infinite_pixels;
    sum.energy_removed += row.energy_removed;
    sum.energy_total += row.energy_total;
}

}  // namespace

RadianceRepairs repair_radiance(EnvironmentMap& map, InvalidRadiance policy, const std::string& where,
                                const Progress& progress) {
    std::vector<RowFacts> facts(map.height);
    parallel_for(map.height, 16, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t y = begin; y < end; ++y) facts[y] = inspect(map.pixels.data() + y * map.width, map.width);
    });
    float largest = 0;
    for (int y = 0; y < map.height; ++y) {
        if (facts[y].first_invalid >= 0 && policy == InvalidRadiance::reject)
            refuse(map, std::size_t(y) * map.width + facts[y].first_invalid, where);
        largest = std::max(largest, facts[y].largest_finite);
    }
    const TexelSolidAngles solid_angles = texel_solid_angles(map);
    parallel_for(map.height, 16, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t y = begin; y < end; ++y)
            clamp_row(map.pixels.data() + y * map.width, solid_angles, int(y), largest, facts[y].repairs);
    });
    RadianceRepairs repairs;
    for (const RowFacts& row : facts) add(repairs, row.repairs);
    return repairs;
}

}  // namespace hairbake
