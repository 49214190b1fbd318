// Accuracy and speed of the irradiance stage, as plain tables.
//
//   bench_irradiance [--quick | --speed]   (--quick: an eleventh of the texels, no 4096 x 2048 maps; --speed: only
//   those)
//
// Times are the best of some runs in this process on all cores; the whole accuracy table takes some minutes on two.
#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/environment/environment_reader.h"
#include "core/environment/environment_writer.h"
#include "core/environment/light_set.h"
#include "core/environment/sh_projection.h"
#include "core/environment/sky_generator.h"
#include "core/irradiance/interpolation_bound.h"
#include "core/irradiance/irradiance_maps.h"
#include "tests/support/pixel_sum.h"

using namespace hairbake;
using namespace hairbake::testing;

namespace {

double best_time(int runs, const std::function<void()>& work) {
    double best = std::numeric_limits<double>::infinity();
    for (int k = 0; k < runs; ++k) {
        const auto begin = std::chrono::steady_clock::now();
        work();
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    return best;
}

struct NamedMap {
    std::string name;
    EnvironmentMap map;
};

std::vector<NamedMap> test_maps() {
    std::vector<NamedMap> maps;
    for (const Sky sky : {Sky::sunny, Sky::studio, Sky::overcast})
        maps.push_back({"generated " + std::string(name_of(sky)), generate_sky(sky, 1024, 1)});
    const char* given = std::getenv("HAIRBAKE_SHARED_DATA");
    const std::filesystem::path folder = std::filesystem::path(given ? given : "../shared/data") / "env";
    Progress progress;
    if (!std::filesystem::is_directory(folder))
        std::printf("no real maps in %s: set HAIRBAKE_SHARED_DATA\n", folder.c_str());
    else
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            maps.push_back({entry.path().stem().string(), read_environment(entry.path(), {}, progress)});
    return maps;
}

IrradianceSettings paper_maps(IrradianceMethod method) {
    IrradianceSettings settings;
    settings.specular_maps = 9;
    settings.method = method;
    return settings;
}

void print_accuracy(int step) {
    std::printf(
        "\nAccuracy against the sum over every pixel: RMS over the largest value of all maps, per cent.\n"
        "16x16x6, p = 64, one diffuse and nine specular maps, %s texels.\n",
        step == 1 ? "all" : "some");
    std::printf("%-24s | %7s | %9s %15s %15s | %15s %9s | %s\n", "map", "exact", "sh auto", "diffuse", "specular",
                "published 3/8", "spec/own", "interpolation bound at 9, 33 maps");
    Progress progress;
    for (const NamedMap& named : test_maps()) {
        const TexelSample sample = sample_texels(16, step);
        const std::vector<Vec3d> truth = sum_over_pixels(named.map, sample.tangents, 64, 9);
        IrradianceSettings settings = paper_maps(IrradianceMethod::exact);
        const IrradianceMaps exact = bake_irradiance(named.map, settings, progress);
        settings.specular_maps = 33;
        const IrradianceMaps fine = bake_irradiance(named.map, settings, progress);
        settings = paper_maps(IrradianceMethod::sh);
        const IrradianceMaps sh = bake_irradiance(named.map, settings, progress);
        settings.sh_bands_diffuse = 3;
        settings.sh_bands_specular = 8;
        const IrradianceMaps published = bake_irradiance(named.map, settings, progress);
        const MapError e = compare(exact, sample.texels, truth), s = compare(sh, sample.texels, truth),
                       p = compare(published, sample.texels, truth);
        std::printf("%-24s | %7.4f | %9.3f %2d: %.3f<%.3f %2d: %.3f<%.3f | %6.2f < %5.2f %8.1f | %.1f, %.1f\n",
                    named.name.c_str(), 100 * e.all, 100 * s.all, sh.sh_bands_diffuse, 100 * s.diffuse,
                    100 * sh.predicted_error_diffuse, sh.sh_bands_specular, 100 * s.specular,
                    100 * sh.predicted_error_specular, 100 * p.specular, 100 * published.predicted_error_specular,
                    100 * p.specular_relative, 100 * exact.interpolation_bound_relative,
                    100 * fine.interpolation_bound_relative);
    }
    std::printf("sh: bands: measured<predicted. spec/own: published specular error over those maps' own RMS value.\n");
}

// As a user of OpenImageIO would: the whole image at once into floats.
void decode(const std::filesystem::path& file) {
    const auto input = OIIO::ImageInput::open(file.string());
    const OIIO::ImageSpec spec = input->spec();
    std::vector<float> pixels(std::size_t(spec.width) * spec.height * spec.nchannels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, pixels.data())) std::abort();
}

void print_speed() {
    Progress progress;
    const auto folder = std::filesystem::temp_directory_path() / ("hairbake_bench_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    std::printf("\n4096 x 2048, p = 64, 16x16x6 on %d threads, seconds (best of 7).\n", thread_count());
    std::printf("%-10s %10s %10s %10s | %8s %8s %8s %8s | %10s %10s\n", "map", "ten exact", "34 exact", "ten sh auto",
                "lights", "bound", "SH 8", "SH 24", "decode hdr", "decode exr");
    for (const Sky sky : {Sky::sunny, Sky::studio, Sky::overcast}) {
        const EnvironmentMap map = generate_sky(sky, 4096, 1);
        const LightSet lights = make_light_set(map, 64, progress);
        const IrradianceSettings nine = paper_maps(IrradianceMethod::exact), sh = paper_maps(IrradianceMethod::sh);
        const double ten = best_time(7, [&] { bake_irradiance(map, nine, progress); });
        const double many = best_time(7, [&] { bake_irradiance(map, {}, progress); });
        const double harmonics = best_time(7, [&] { bake_irradiance(map, sh, progress); });
        const double binning = best_time(7, [&] { make_light_set(map, 64, progress); });
        const double bound = best_time(7, [&] { interpolation_bound(lights, 64, 9, progress); });
        const double project8 = best_time(7, [&] { project_sh(map, 8, progress); });
        const double project24 = best_time(7, [&] { project_sh(map, 24, progress); });
        write_environment(map, folder / "map.hdr");
        write_environment(map, folder / "map.exr");
        const double hdr = best_time(7, [&] { decode(folder / "map.hdr"); });
        const double exr = best_time(7, [&] { decode(folder / "map.exr"); });
        std::printf(
            "%-10s %10.3f %10.3f %10.3f | %8.3f %8.3f %8.3f %8.3f | %10.3f %10.3f  stage/hdr %.2f stage/exr %.2f\n",
            name_of(sky).data(), ten, many, harmonics, binning, bound, project8, project24, hdr, exr, ten / hdr,
            ten / exr);
    }
    std::filesystem::remove_all(folder);
}

}  // namespace

int main(int argc, char** argv) {
    const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
    const bool speed = argc > 1 && std::strcmp(argv[1], "--speed") == 0;
    if (!quick) print_speed();
    if (!speed) print_accuracy(quick ? 11 : 1);
}
