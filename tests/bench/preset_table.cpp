// Accuracy of the presets draft and final and of the default settings, on grooms of many kinds.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "core/hair/hair_file.h"
#include "core/mesh/mesh_file.h"
#include "core/reference/error_bar.h"
#include "core/request/request_presets.h"
#include "tests/bench/transmittance_bench.h"
#include "tests/support/shared_data.h"

namespace hairbake::bench {
namespace {

constexpr int scored = 2000;

TransmittanceSettings settings_of(const std::string& preset) {
    BakeRequest request;
    if (preset != "default") apply_preset(request, preset);
    return request.transmittance;
}

void print_presets(const std::string& name, const StrandGeometry& strands, const TriangleMesh* occluder = nullptr) {
    Progress progress;
    const StrandScene scene(strands, progress, occluder);
    for (const char* preset : {"draft", "default", "final"}) {
        Transmittance baked;
        const double taken = seconds([&] {
            baked = bake_transmittance_volume({strands, occluder}, settings_of(preset), progress);
        });
        const ErrorBar bar = measure_error(scene, baked.average, scored, 2, progress);
        const Vec3f side = strands.bounds_max - strands.bounds_min;
        std::printf("| %s | %s | volume | %.0f | %.2f | %.4f | %.4f (%.4f to %.4f) | %+.4f | %.4f | %+.4f |\n",
                    name.c_str(), preset, std::max({side.x, side.y, side.z}) / baked.voxel_size, taken,
                    bar.outside.noise, bar.outside.rmse, bar.outside.rmse_ci95[0], bar.outside.rmse_ci95[1],
                    bar.outside.bias, bar.clear.rmse, bar.clear.bias);
        std::fflush(stdout);
    }
}

StrandGeometry read_strands(const std::filesystem::path& file, std::optional<double> width = {}) {
    StrandSettings settings;
    settings.width = width;
    return make_strand_geometry(read_hair(file), settings);
}

}  // namespace

void preset_table(const BenchOptions& options) {
    std::printf(
        "\n## The presets against Embree with %d directions, %d vertices outside other strands\n\n"
        "| model | preset | method | voxels | seconds | noise | RMSE (95 %% interval), noise taken off | bias | RMSE, "
        "a "
        "width away from other strands | bias |\n|---|---|---|---|---|---|---|---|---|---|\n",
        reference_directions, scored);
    print_presets("generated curly", groom(GroomStyle::curly, options.vertices()));
    print_presets("generated straight", groom(GroomStyle::straight, options.vertices()));
    print_presets("generated curly, 20,000 vertices", groom(GroomStyle::curly, 20'000));
    const auto folder = test_support::shared_data("hair");
    if (!std::filesystem::is_directory(folder)) {
        std::printf("no real models in %s: set HAIRBAKE_SHARED_DATA\n", folder.c_str());
        return;
    }
    const StrandGeometry sintel = read_strands(folder / "sintel.hair");
    const TriangleMesh head = read_mesh(test_support::shared_data("mesh") / "sintel.obj");
    print_presets("Sintel", sintel);
    print_presets("Sintel and her head", sintel, &head);
    print_presets("fur ball", read_strands(folder / "fur.hair"));
    print_presets("TressFX tail, width 0.05", read_strands(folder / "tressfx_tail.tfx", 0.05));
    print_presets("mohawk, width 0.001", read_strands(folder / "ratboy_mohawk.tfx", 0.001));
    for (const char* name : {"beard", "lashes"})
        print_presets(name, read_strands(test_support::shared_data("cases") / (std::string(name) + ".hair")));
}

}  // namespace hairbake::bench
