// Layered deep opacity maps beside the volume method.
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <utility>

#include "core/hair/hair_file.h"
#include "core/reference/error_bar.h"
#include "core/reference/tracer.h"
#include "core/visibility/direction_set.h"
#include "core/volume/opacity_transmittance.h"
#include "tests/bench/transmittance_bench.h"
#include "tests/support/shared_data.h"

namespace hairbake::bench {
namespace {

TransmittanceSettings maps(int layers, double spacing, int resolution) {
    TransmittanceSettings settings;
    settings.method = TransmittanceMethod::opacity_maps;
    settings.opacity_maps = {layers, spacing, resolution};
    return settings;
}

/// Both methods with the same 100 directions, against one trace.
void opacity_map_rows(const std::string& name, const StrandGeometry& strands) {
    Progress progress;
    const auto vertices = scored_vertices(strands);
    const StrandScene scene(strands, progress);
    const auto traced =
        trace_transmittance(scene, vertices, make_directions(DirectionSet::fibonacci, 1024, 0), progress);
    const std::pair<const char*, TransmittanceSettings> methods[] = {
        {"volume, 256 voxels", {}},
        {"3 layers 1:2:4, 512 texels (default)", maps(3, 2, 512)},
        {"3 layers 1:2:4, 128 texels", maps(3, 2, 128)},
        {"3 layers 1:2:4, 1024 texels", maps(3, 2, 1024)},
        {"3 equal layers, 512 texels", maps(3, 1, 512)},
        {"16 equal layers, 512 texels", maps(16, 1, 512)},
    };
    for (const auto& [method, settings] : methods) {
        Transmittance baked;
        const std::clock_t begin = std::clock();
        const double wall = seconds([&, &s = settings] {
            baked = s.method == TransmittanceMethod::opacity_maps
                        ? bake_transmittance_opacity_maps({strands}, s, progress)
                        : bake_transmittance_volume({strands}, s, progress);
        });
        const double cpu = double(std::clock() - begin) / CLOCKS_PER_SEC;
        const ErrorFigures bar = error_statistics(at(vertices, baked.average), traced);
        std::printf("| %s | %s | %.4f (%.4f to %.4f) | %+.4f | %.2f | %.2f |\n", name.c_str(), method, bar.rmse,
                    bar.rmse_ci95[0], bar.rmse_ci95[1], bar.bias, wall, cpu);
        std::fflush(stdout);
    }
}

}  // namespace

void opacity_map_table() {
    std::printf(
        "\n## Deep opacity maps beside the volume method: 200,000 vertices, 100 directions, against Embree with 1,024 "
        "directions\n\n| model | method | RMSE (95 %% interval) | bias | seconds | CPU seconds "
        "|\n|---|---|---|---|---|---|\n");
    opacity_map_rows("generated curly", groom(GroomStyle::curly, 200'000));
    opacity_map_rows("generated straight", groom(GroomStyle::straight, 200'000));
    const auto file = test_support::shared_data("hair/sintel.hair");
    if (std::filesystem::exists(file)) opacity_map_rows("Sintel", make_strand_geometry(read_hair(file), {}));
}

}  // namespace hairbake::bench
