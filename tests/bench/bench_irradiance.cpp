// Accuracy and speed of the irradiance stage, as plain tables.
//
//   bench_irradiance [--quick | --speed]
//                    (--quick: an eleventh of the texels, no 4096 x 2048 maps; --speed: only those maps)
//
// Times are the best of some runs in this process on all cores; the whole accuracy table takes some minutes on two.
#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
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
#include "core/irradiance/irradiance_maps.h"
#include "core/sample/sky_generator.h"
#include "tests/support/pixel_sum.h"
#include "tests/support/shared_data.h"

using namespace hairbake;
using namespace hairbake::testing;

namespace {

struct Cost {
    double wall = std::numeric_limits<double>::infinity(), cpu = wall;  // seconds; cpu over all threads
};

// The best of some runs of each piece of work, taken in turns, so that a busy machine treats them alike.
std::vector<Cost> best_costs(int runs, const std::vector<std::function<void()>>& works) {
    std::vector<Cost> best(works.size());
    for (int k = 0; k < runs; ++k)
        for (std::size_t i = 0; i < works.size(); ++i) {
            const std::clock_t cpu = std::clock();
            const auto begin = std::chrono::steady_clock::now();
            works[i]();
            const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
            best[i].wall = std::min(best[i].wall, wall.count());
            best[i].cpu = std::min(best[i].cpu, double(std::clock() - cpu) / CLOCKS_PER_SEC);
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
    const auto folder = test_support::shared_data("env");
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
        "\nAccuracy against the sum over every pixel: RMS over the largest value of the lobe's maps, per cent.\n"
        "16x16x6, p = 64, one diffuse and nine specular maps, %s texels.\n",
        step == 1 ? "all" : "some");
    std::printf("%-24s | %7s %8s | %15s %15s | %15s %9s | %s\n", "map", "exact d", "exact s", "sh auto, diffuse",
                "specular", "published 3/8", "spec/own", "interpolation bound at 9, 33 maps");
    Progress progress;
    for (const NamedMap& named : test_maps()) {
        const TexelSample sample = sample_texels(16, step);
        const std::vector<Vec3d> truth = sum_over_pixels(named.map, sample.tangents, 64, 9);
        IrradianceSettings settings = paper_maps(IrradianceMethod::exact);
        const IrradianceMaps exact = bake_irradiance(named.map, settings, {}, progress);
        settings.specular_maps = 33;
        const IrradianceMaps fine = bake_irradiance(named.map, settings, {}, progress);
        settings = paper_maps(IrradianceMethod::sh);
        const IrradianceMaps sh = bake_irradiance(named.map, settings, {}, progress);
        settings.sh_bands_diffuse = 3;
        settings.sh_bands_specular = 8;
        const IrradianceMaps published = bake_irradiance(named.map, settings, {}, progress);
        const MapError e = compare(exact, sample.texels, truth), s = compare(sh, sample.texels, truth),
                       p = compare(published, sample.texels, truth);
        std::printf("%-24s | %7.4f %8.4f | %2d: %.3f<%.3f %2d: %.3f<%.3f | %6.2f < %5.2f %8.1f | %.1f, %.1f\n",
                    named.name.c_str(), 100 * e.diffuse, 100 * e.specular, sh.sh_bands_diffuse, 100 * s.diffuse,
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
    std::printf("\n4096 x 2048, p = 64, 16x16x6 on %d threads, wall seconds (CPU seconds), best of 9 in turns.\n",
                thread_count());
    for (const Sky sky : {Sky::sunny, Sky::studio, Sky::overcast}) {
        const EnvironmentMap map = generate_sky(sky, 4096, 1);
        const LightSet lights = make_light_set(map, 64, progress);
        const IrradianceSettings nine = paper_maps(IrradianceMethod::exact), sh = paper_maps(IrradianceMethod::sh);
        write_environment(map, folder / "map.hdr");
        write_environment(map, folder / "map.exr");
        const char* names[] = {"ten maps, exact",   "decode .hdr",     "decode .exr",         "34 maps, exact",
                               "ten maps, sh auto", "of them: lights", "SH, 8 bands (exact)", "SH, 24 bands"};
        const std::vector<Cost> costs =
            best_costs(9, {[&] { bake_irradiance(map, nine, {}, progress); }, [&] { decode(folder / "map.hdr"); },
                           [&] { decode(folder / "map.exr"); }, [&] { bake_irradiance(map, {}, {}, progress); },
                           [&] { bake_irradiance(map, sh, {}, progress); }, [&] { make_light_set(map, 64, progress); },
                           [&] { project_sh(map, 8, progress); }, [&] { project_sh(map, 24, progress); }});
        std::printf("%s, %zu lights\n", name_of(sky).data(), lights.size());
        for (std::size_t i = 0; i < costs.size(); ++i)
            std::printf("  %-22s %7.3f (%.3f)\n", names[i], costs[i].wall, costs[i].cpu);
        std::printf("  stage / decode         hdr %.2f (%.2f)   exr %.2f (%.2f)\n", costs[0].wall / costs[1].wall,
                    costs[0].cpu / costs[1].cpu, costs[0].wall / costs[2].wall, costs[0].cpu / costs[2].cpu);
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
