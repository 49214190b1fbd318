// Any bytes as an HDR or PFM picture: refused, or read as a lat-long map or a cube of valid radiance, whose
// lights and harmonics carry all of its energy. (The decoders are OpenImageIO's; other formats are left to it alone.)
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "core/environment/environment_reader.h"
#include "core/environment/light_set.h"
#include "core/environment/sh_projection.h"
#include "tests/fuzz/demand.h"

namespace {

using namespace hairbake;

// One file for the whole run, of this process.
const std::filesystem::path& picture() {
    static const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("hairbake-fuzz-environment-" + std::to_string(::getpid()));
    return file;
}

bool near(double a, double b, double scale) { return std::abs(a - b) <= 1e-6 * scale; }

void check(const EnvironmentMap& map) {
    const bool cube = map.shape == EnvironmentShape::cube;
    demand(map.width > 0 && map.height == (cube ? 6 * map.width : map.width / 2), "the size is that of the shape");
    demand(map.pixels.size() == std::size_t(map.width) * map.height, "there is a value for every texel");
    float largest = 0;
    for (const Vec3f& p : map.pixels)
        for (int channel = 0; channel < 3; ++channel) {
            demand(p[channel] >= 0 && std::isfinite(p[channel]), "radiance is finite and not negative");
            largest = std::max(largest, p[channel]);
        }
    const double energy = map.repairs.energy_total;
    demand(energy >= 0 && energy <= 3 * 4.001 * std::numbers::pi * largest, "energy is at most that of the brightest");
    if (largest > 1e30f) return;  // the lights' flux leaves single precision
    Progress progress;
    const LightSet lights = make_light_set(map, 8, progress);
    demand(near(lights.total.x + lights.total.y + lights.total.z, energy, energy), "the lights carry the energy");
    const Vec3d mean = project_sh(map, 3, progress)[0] * std::sqrt(4 * std::numbers::pi);
    demand(near(mean.x + mean.y + mean.z, energy, energy), "the first harmonic carries the energy");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    if (!bytes.starts_with("#?") && !bytes.starts_with("PF") && !bytes.starts_with("Pf")) return 0;
    std::ofstream(picture(), std::ios::binary | std::ios::trunc) << bytes;
    for (const InvalidRadiance policy : {InvalidRadiance::clamp, InvalidRadiance::reject}) {
        EnvironmentSettings settings;
        settings.invalid_radiance = policy;
        Progress progress;
        try {
            check(read_environment(picture(), settings, progress));
        } catch (const Error& error) {
            demand(error.kind() == ErrorKind::bad_input, "an input's fault is bad_input");
            demand(error.what()[0] != 0, "a refusal has a message");
        }
    }
    std::filesystem::remove(picture());
    return 0;
}
