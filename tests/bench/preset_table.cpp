// Accuracy of the presets draft and final and of the default settings, on grooms of many kinds.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/hair/hair_file.h"
#include "core/mesh/mesh_file.h"
#include "core/reference/error_bar.h"
#include "core/reference/tracer.h"
#include "core/request/request_presets.h"
#include "core/stages/transmittance_method.h"
#include "core/visibility/direction_set.h"
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

/// What the stage computes with `settings`: by tracing or by the sweep. Only `scored` vertices are traced.
Transmittance bake_as_asked(const StrandScene& scene, const TriangleMesh* occluder,
                            std::span<const std::uint32_t> scored, const TransmittanceSettings& settings) {
    Progress progress;
    const StrandGeometry& strands = scene.strands();
    if (choose_method(settings, strands.vertex_count(), 0).method != TransmittanceMethod::trace)
        return bake_transmittance_volume({strands, occluder}, settings, progress);
    Transmittance traced;
    traced.directions = traced_directions(settings.directions);
    const auto directions = make_directions(settings.direction_set, traced.directions, settings.seed);
    const std::vector<float> average = trace_transmittance(scene, scored, directions, progress);
    traced.average.resize(strands.vertex_count());
    for (std::size_t i = 0; i < scored.size(); ++i) traced.average[scored[i]] = average[i];
    return traced;
}

std::string voxels_of(const StrandGeometry& strands, double voxel_size) {
    if (!(voxel_size > 0)) return "traced";
    const Vec3f side = strands.bounds_max - strands.bounds_min;
    return std::to_string(std::lround(std::max({side.x, side.y, side.z}) / voxel_size));
}

void print_presets(const std::string& name, const StrandGeometry& strands, const TriangleMesh* occluder = nullptr) {
    Progress progress;
    const StrandScene scene(strands, progress, occluder);
    const ErrorReference reference(scene, scored, 2, progress);
    for (const char* preset : {"draft", "default", "final"}) {
        Transmittance baked;
        const double taken =
            seconds([&] { baked = bake_as_asked(scene, occluder, reference.vertices(), settings_of(preset)); });
        const ErrorBar bar = reference.compare(baked.average);
        std::printf("| %s | %s | %s | %d | %.2f | %.4f | %.4f (%.4f to %.4f) | %+.4f | %.4f | %+.4f |\n", name.c_str(),
                    preset, voxels_of(strands, baked.voxel_size).c_str(), baked.directions, taken, bar.outside.noise,
                    bar.outside.rmse, bar.outside.rmse_ci95[0], bar.outside.rmse_ci95[1], bar.outside.bias,
                    bar.clear.rmse, bar.clear.bias);
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
        "| model | preset | voxels | directions | seconds (of the sweep, or of tracing the scored vertices alone) | "
        "noise | RMSE (95 %% interval), noise taken off | bias | "
        "RMSE, "
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
