// Accuracy of the volume method against Embree, with and without an occluder.
#include <cstdio>
#include <filesystem>
#include <numeric>

#include "core/hair/hair_file.h"
#include "core/mesh/mesh_file.h"
#include "core/reference/error_bar.h"
#include "core/reference/tracer.h"
#include "core/sample/head_mesh.h"
#include "core/visibility/direction_set.h"
#include "tests/bench/transmittance_bench.h"
#include "tests/support/shared_data.h"

namespace hairbake::bench {
namespace {

void print_accuracy(const std::string& name, const StrandGeometry& strands, const char* target,
                    const TriangleMesh* occluder = nullptr) {
    Progress progress;
    const Transmittance baked = bake_transmittance_volume({strands, occluder}, {}, progress);
    const auto vertices = scored_vertices(strands);
    const StrandScene scene(strands, progress, occluder);
    const TracedHalves halves = trace_reference(scene, vertices, progress);
    const auto traced = halves.mean();
    const ErrorFigures bar = error_statistics(at(vertices, baked.average), halves);
    const double mean = std::accumulate(traced.begin(), traced.end(), 0.0) / double(traced.size());
    std::printf("| %s | %zu | %u | %.3f | %.4f | %.4f (%.4f to %.4f) | %+.4f | %s |\n", name.c_str(),
                strands.vertex_count(), bar.vertices, mean, bar.noise, bar.rmse, bar.rmse_ci95[0], bar.rmse_ci95[1],
                bar.bias, target);
    std::fflush(stdout);
}

}  // namespace

void accuracy_table(const BenchOptions& options) {
    std::printf(
        "\n## Accuracy: 256 voxels, 100 directions, against Embree with %d directions\n\n"
        "| model | vertices | scored | mean A | noise | RMSE (95 %% interval), noise taken off | bias | target "
        "|\n|---|---|---|---|---|---|---|---|\n",
        reference_directions);
    const char* target = "RMSE <= 0.015, abs. bias <= 0.006";
    print_accuracy("generated curly", groom(GroomStyle::curly, options.vertices()), target);
    print_accuracy("generated straight", groom(GroomStyle::straight, options.vertices()), target);
    print_accuracy("generated wavy", groom(GroomStyle::wavy, options.vertices()), "none");
    const auto folder = test_support::shared_data("hair");
    if (!std::filesystem::is_directory(folder)) {
        std::printf("no real models in %s: set HAIRBAKE_SHARED_DATA\n", folder.c_str());
        return;
    }
    print_accuracy("Sintel", make_strand_geometry(read_hair(folder / "sintel.hair"), {}), "RMSE <= 0.018");
    print_accuracy("fur ball", make_strand_geometry(read_hair(folder / "fur.hair"), {}), "none");
}

void occluder_table(const BenchOptions& options) {
    std::printf(
        "\n## Accuracy with an occluder: 256 voxels, 100 directions, against Embree with %d directions\n\n"
        "| model | vertices | scored | mean A | noise | RMSE (95 %% interval), noise taken off | bias | target "
        "|\n|---|---|---|---|---|---|---|---|\n",
        reference_directions);
    const char* target = "RMSE <= 0.03";
    const TriangleMesh head = make_head_mesh();
    const StrandGeometry curly = groom(GroomStyle::curly, options.vertices());
    print_accuracy("curly and its head", curly, target, &head);
    print_accuracy("straight and its head", groom(GroomStyle::straight, options.vertices()), target, &head);
    const auto folder = test_support::shared_data("");
    if (std::filesystem::is_directory(folder / "mesh")) {
        const TriangleMesh mesh = read_mesh(folder / "mesh" / "sintel.obj");
        const StrandGeometry sintel = make_strand_geometry(read_hair(folder / "hair" / "sintel.hair"), {});
        print_accuracy("Sintel and her head", sintel, target, &mesh);
    } else {
        std::printf("no real models in %s: set HAIRBAKE_SHARED_DATA\n", folder.c_str());
    }
    const double alone = time_bake({curly}, {}), with_head = time_bake({curly, &head}, {});
    std::printf("\ntime, %zu vertices: %.2f s without, %.2f s with the head (%zu triangles)\n", curly.vertex_count(),
                alone, with_head, head.triangles.size());
}

}  // namespace hairbake::bench
