// Accuracy, speed and memory of the transmittance stage, as plain tables.
//
//   bench_transmittance [--quick]      (--quick: models of 200,000 vertices, 1,024 reference directions)
//   bench_transmittance --opacity-maps (layered deep opacity maps beside the volume method, 200,000 vertices)
//   bench_transmittance --occluder     (the accuracy and time with an occluder alone)
//   bench_transmittance --directional  (harmonics, bent cones and receivers alone; with --quick after it: 200,000
//                                       vertices)
//
// Every ratio is taken within this run: the peers are timed on a sample of the same model's vertices and scaled.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/hair/hair_file.h"
#include "core/mesh/mesh_file.h"
#include "core/reference/error_bar.h"
#include "core/reference/nearest_strand.h"
#include "core/reference/tracer.h"
#include "core/sample/groom_generator.h"
#include "core/sample/head_mesh.h"
#include "core/visibility/direction_set.h"
#include "core/volume/density_grid.h"
#include "core/volume/opacity_transmittance.h"
#include "core/volume/transmittance.h"
#include "tests/bench/floor.h"
#include "tests/bench/vdb_march.h"
#include "tests/support/shared_data.h"

using namespace hairbake;

namespace {

struct Options {
    bool quick = false;
    std::size_t vertices() const { return quick ? 200'000 : 1'500'000; }
    int reference_directions() const { return quick ? 1024 : 4096; }
};

double seconds(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

StrandGeometry groom(GroomStyle style, std::size_t vertices, std::uint32_t per_strand = 30) {
    GroomSettings settings;
    settings.style = style;
    settings.vertices = vertices;
    settings.vertices_per_strand = per_strand;
    return make_strand_geometry(generate_groom(settings), {});
}

/// Seconds of the best of three runs: the machine is shared.
template <class Body>
double best_of_three(const Body& body) {
    double best = 1e9;
    for (int run = 0; run < 3; ++run) best = std::min(best, seconds(body));
    return best;
}

double time_bake(const StrandGeometry& strands, const TransmittanceSettings& settings, Transmittance* result = nullptr,
                 const TriangleMesh* occluder = nullptr) {
    Progress progress;
    return best_of_three([&] {
        Transmittance baked = bake_transmittance_volume({strands, occluder}, settings, progress);
        if (result) *result = std::move(baked);
    });
}

/// 2,000 random vertices that are at least one width away from any strand that is not their own.
std::vector<std::uint32_t> scored_vertices(const StrandGeometry& strands) {
    Random random(7);
    std::vector<std::uint32_t> drawn(4000), kept;
    for (auto& v : drawn) v = static_cast<std::uint32_t>(random.next() * double(strands.vertex_count()));
    std::sort(drawn.begin(), drawn.end());
    const auto distance = distance_to_other_strands(strands, drawn, 2);
    for (std::size_t k = 0; k < drawn.size(); ++k)
        if (distance[k] >= 1) kept.push_back(drawn[k]);
    std::vector<std::uint32_t> spread;
    const std::size_t count = std::min<std::size_t>(2000, kept.size());
    for (std::size_t k = 0; k < count; ++k) spread.push_back(kept[k * kept.size() / count]);
    return spread;
}

void print_accuracy(const std::string& name, const StrandGeometry& strands, const char* target, const Options& options,
                    const TriangleMesh* occluder = nullptr) {
    Progress progress;
    const Transmittance baked = bake_transmittance_volume({strands, occluder}, {}, progress);
    const auto vertices = scored_vertices(strands);
    const StrandScene scene(strands, progress, occluder);
    const auto directions = make_directions(DirectionSet::fibonacci, options.reference_directions(), 0);
    const auto traced = trace_transmittance(scene, vertices, directions, progress);
    std::vector<float> average;
    for (const std::uint32_t v : vertices) average.push_back(baked.average[v]);
    const ErrorBar bar = error_statistics(average, traced);
    const double mean = std::accumulate(traced.begin(), traced.end(), 0.0) / double(traced.size());
    std::printf("| %s | %zu | %u | %.3f | %.4f (%.4f to %.4f) | %+.4f | %s |\n", name.c_str(), strands.vertex_count(),
                bar.vertices, mean, bar.rmse, bar.rmse_ci95[0], bar.rmse_ci95[1], bar.bias, target);
    std::fflush(stdout);
}

void accuracy_table(const Options& options) {
    std::printf(
        "\n## Accuracy: 256 voxels, 100 directions, against Embree with %d directions\n\n"
        "| model | vertices | scored | mean A | RMSE (95 %% interval) | bias | target "
        "|\n|---|---|---|---|---|---|---|\n",
        options.reference_directions());
    const char* target = "RMSE <= 0.015, abs. bias <= 0.006";
    print_accuracy("generated curly", groom(GroomStyle::curly, options.vertices()), target, options);
    print_accuracy("generated straight", groom(GroomStyle::straight, options.vertices()), target, options);
    print_accuracy("generated wavy", groom(GroomStyle::wavy, options.vertices()), "none", options);
    const auto folder = test_support::shared_data("hair");
    if (!std::filesystem::is_directory(folder)) {
        std::printf("no real models in %s: set HAIRBAKE_SHARED_DATA\n", folder.c_str());
        return;
    }
    print_accuracy("Sintel", make_strand_geometry(read_hair(folder / "sintel.hair"), {}), "RMSE <= 0.018", options);
    print_accuracy("fur ball", make_strand_geometry(read_hair(folder / "fur.hair"), {}), "none", options);
}

/// The heads under their hair: the truth is Embree with the mesh.
void occluder_table(const Options& options) {
    std::printf(
        "\n## Accuracy with an occluder: 256 voxels, 100 directions, against Embree with %d directions\n\n"
        "| model | vertices | scored | mean A | RMSE (95 %% interval) | bias | target "
        "|\n|---|---|---|---|---|---|---|\n",
        options.reference_directions());
    const char* target = "RMSE <= 0.03";
    const TriangleMesh head = make_head_mesh();
    const StrandGeometry curly = groom(GroomStyle::curly, options.vertices());
    print_accuracy("curly and its head", curly, target, options, &head);
    print_accuracy("straight and its head", groom(GroomStyle::straight, options.vertices()), target, options, &head);
    const auto folder = test_support::shared_data("");
    if (std::filesystem::is_directory(folder / "mesh")) {
        const TriangleMesh mesh = read_mesh(folder / "mesh" / "sintel.obj");
        const StrandGeometry sintel = make_strand_geometry(read_hair(folder / "hair" / "sintel.hair"), {});
        print_accuracy("Sintel and her head", sintel, target, options, &mesh);
    } else {
        std::printf("no real models in %s: set HAIRBAKE_SHARED_DATA\n", folder.c_str());
    }
    const double alone = time_bake(curly, {}), with_head = time_bake(curly, {}, nullptr, &head);
    std::printf("\ntime, %zu vertices: %.2f s without, %.2f s with the head (%zu triangles)\n", curly.vertex_count(),
                alone, with_head, head.triangles.size());
}

/// What harmonics and bent cones cost beside A alone: all in turn, best of three.
void directional_times(const StrandGeometry& strands) {
    struct Row {
        const char* name;
        int bands;
        bool cone;
        double best = 1e9;
    };
    std::array<Row, 7> rows{{{"A alone", 0, false},
                             {"1 band", 1, false},
                             {"2 bands", 2, false},
                             {"3 bands", 3, false},
                             {"4 bands", 4, false},
                             {"bent cone", 0, true},
                             {"2 bands and bent cone", 2, true}}};
    for (int turn = 0; turn < 3; ++turn)
        for (Row& row : rows) {
            TransmittanceSettings settings;
            settings.sh_bands = row.bands;
            settings.bent_cone = row.cone;
            Progress progress;
            row.best = std::min(row.best, seconds([&] { bake_transmittance_volume({strands}, settings, progress); }));
        }
    std::printf(
        "\n## Directional transmittance: %zu vertices, 256 voxels, 100 directions\n\n| answer | seconds | times A "
        "alone "
        "|\n|---|---|---|\n",
        strands.vertex_count());
    for (const Row& row : rows) std::printf("| %s | %.2f | %.2f |\n", row.name, row.best, row.best / rows[0].best);
    std::fflush(stdout);
}

/// Root of the mean square of baked - traced, over `count` items from component c of `stride`.
double component_rmse(std::span<const float> baked, std::span<const float> traced, std::size_t stride, std::size_t c) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = c; i < baked.size(); i += stride, ++count) sum += std::pow(double(baked[i]) - traced[i], 2);
    return std::sqrt(sum / double(count));
}

/// Coefficients against the traced ones, by band: error and size of a coefficient, root of the mean square over the
/// scored vertices and the band's m.
void sh_accuracy(const std::string& name, const StrandGeometry& strands, const Options& options) {
    constexpr std::size_t count = 16;
    Progress progress;
    TransmittanceSettings settings;
    settings.sh_bands = 4;
    settings.bent_cone = true;
    const Transmittance baked = bake_transmittance_volume({strands}, settings, progress);
    const auto vertices = scored_vertices(strands);
    const StrandScene scene(strands, progress);
    const auto directions = make_directions(DirectionSet::fibonacci, options.reference_directions(), 0);
    const DirectionalMeans traced = trace_directional(scene, vertices, directions, 4, true, progress);
    std::vector<float> sh;
    for (const std::uint32_t v : vertices) sh.insert(sh.end(), &baked.sh[v * count], &baked.sh[v * count] + count);
    const std::vector<float> nothing(sh.size());
    std::printf("| %s |", name.c_str());
    for (std::size_t l = 0; l < 4; ++l) {
        double error = 0, size = 0;
        for (std::size_t i = l * l; i < (l + 1) * (l + 1); ++i) {
            error += std::pow(component_rmse(sh, traced.sh, count, i), 2) / double(2 * l + 1);
            size += std::pow(component_rmse(nothing, traced.sh, count, i), 2) / double(2 * l + 1);
        }
        std::printf(" %.4f of %.4f |", std::sqrt(error), std::sqrt(size));
    }
    // Bent cones where a tenth of the sky is seen at least: elsewhere few rays decide.
    double angle = 0, axis = 0;
    std::size_t scored = 0;
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        const float *a = &baked.bent_cone[4 * std::size_t{vertices[k]}], *b = &traced.bent_cone[4 * k];
        if (traced.average[k] < 0.1f || b[3] > 3.14f) continue;
        angle += std::pow(double(a[3]) - b[3], 2);
        axis += std::pow(
            std::acos(std::clamp(double(a[0]) * b[0] + double(a[1]) * b[1] + double(a[2]) * b[2], -1.0, 1.0)), 2);
        ++scored;
    }
    const double degrees = 180 / std::numbers::pi;
    std::printf(" %.1f | %.1f |\n", degrees * std::sqrt(axis / double(scored)),
                degrees * std::sqrt(angle / double(scored)));
    std::fflush(stdout);
}

void receiver_accuracy(const std::string& name, const StrandGeometry& strands, const TriangleMesh& receiver,
                       const Options& options) {
    Progress progress;
    TransmittanceScene model{strands};
    const double alone = seconds([&] { bake_transmittance_volume(model, {}, progress); });
    model.receiver = &receiver;
    Transmittance baked;
    const double with = seconds([&] { baked = bake_transmittance_volume(model, {}, progress); });
    const StrandScene scene(strands, progress);
    const auto directions = make_directions(DirectionSet::fibonacci, options.reference_directions() / 4, 0);
    const auto traced = trace_receiver(scene, receiver, false, directions, progress);
    double bias[2] = {0, 0}, mean[2] = {0, 0};
    for (std::size_t i = 0; i < traced.size(); ++i) {
        bias[i % 2] += (double(baked.receiver[i]) - traced[i]) * 2 / double(traced.size());
        mean[i % 2] += 2 * double(traced[i]) / double(traced.size());
    }
    std::printf("| %s | %zu | %.3f, %.3f | %.4f, %.4f | %+.4f, %+.4f | %.2f, %.2f |\n", name.c_str(),
                receiver.positions.size(), mean[0], mean[1], component_rmse(baked.receiver, traced, 2, 0),
                component_rmse(baked.receiver, traced, 2, 1), bias[0], bias[1], alone, with);
    std::fflush(stdout);
}

void directional_tables(const Options& options) {
    const StrandGeometry curly = groom(GroomStyle::curly, options.vertices());
    directional_times(curly);
    std::printf(
        "\n## Harmonics and bent cones against Embree with %d directions: RMSE of a coefficient, of its size\n\n"
        "| model | band 0 | band 1 | band 2 | band 3 | axis, degrees | half-angle, degrees "
        "|\n|---|---|---|---|---|---|---|\n",
        options.reference_directions());
    const StrandGeometry straight = groom(GroomStyle::straight, options.vertices());
    sh_accuracy("generated curly", curly, options);
    sh_accuracy("generated straight", straight, options);
    const auto folder = test_support::shared_data("hair");
    if (std::filesystem::is_directory(folder))
        sh_accuracy("Sintel", make_strand_geometry(read_hair(folder / "sintel.hair"), {}), options);
    std::printf(
        "\n## Receiver: the generated head, means over the hemisphere, plain and cosine-weighted, against Embree\n\n"
        "| model | points | mean | RMSE | bias | seconds without and with |\n|---|---|---|---|---|---|\n");
    const TriangleMesh head = make_head_mesh(48);
    receiver_accuracy("generated curly", curly, head, options);
    receiver_accuracy("generated straight", straight, head, options);
}

/// Vertices of whole strands spread over the groom, about `count` of them.
std::vector<std::uint32_t> spread_strands(const StrandGeometry& strands, std::size_t count) {
    const std::size_t per_strand = strands.vertex_count() / strands.strand_count();
    const std::size_t wanted = std::min(strands.strand_count(), count / per_strand);
    std::vector<std::uint32_t> vertices;
    for (std::size_t k = 0; k < wanted; ++k) {
        const std::size_t s = k * strands.strand_count() / wanted;
        for (std::uint32_t v = strands.strand_begin[s]; v < strands.strand_begin[s + 1]; ++v) vertices.push_back(v);
    }
    return vertices;
}

void speed_table(const std::string& name, const StrandGeometry& strands) {
    Progress progress;
    Transmittance baked;
    const double ours = time_bake(strands, {}, &baked);
    const auto directions = make_directions(DirectionSet::fibonacci, 100, 1);
    const auto scale = [&](std::size_t sample) { return double(strands.vertex_count()) / double(sample); };

    const StrandScene scene(strands, progress);
    const auto traced = spread_strands(strands, 30'000);
    const double embree =
        best_of_three([&] { trace_transmittance(scene, traced, directions, progress); }) * scale(traced.size());

    const auto file = std::filesystem::temp_directory_path() / "hairbake_bench_density.vdb";
    baked.density->write(file);
    std::vector<Vec3f> positions;
    for (const std::uint32_t v : spread_strands(strands, 6'000)) positions.push_back(strands.positions[v]);
    std::vector<float> average;
    double march = 1e9;
    for (int run = 0; run < 3; ++run)
        march = std::min(march, bench::time_vdb_march(file, positions, directions, average) * scale(positions.size()));
    std::filesystem::remove(file);

    std::printf("| %s | %.2f | %.0f | %.0f | %.0f | %.0f |\n", name.c_str(), ours, embree, embree / ours, march,
                march / ours);
    std::fflush(stdout);
}

void floors(const StrandGeometry& strands) {
    const double terms = double(strands.vertex_count()) * 100;
    const double bandwidth = bench::memory_bandwidth();
    Progress progress;
    Transmittance baked;
    const double ours = time_bake(strands, {}, &baked);
    // Four directions share one pass. A pass reads 16 bytes and reads and writes 16 bytes of sums a vertex, and reads
    // 12 bytes of tensor for every voxel of an occupied brick; the rays stay in the cache.
    const double bytes = terms / 4 * (16 + 2 * 16) + 25.0 * 12 * double(baked.occupied_voxels);
    std::printf("\n## Floors: %zu vertices x 100 directions\n\n", strands.vertex_count());
    std::printf("memory: %.2f GB at least at a measured %.1f GB/s: %.3f s\n", bytes * 1e-9, bandwidth * 1e-9,
                bytes / bandwidth);
    const double arithmetic = bench::arithmetic_time(static_cast<std::size_t>(terms));
    std::printf("arithmetic: a gather, an exp and four sums for each vertex and direction: %.3f s\n", arithmetic);
    std::printf("whole stage: %.2f s, %.1f times the larger floor\n", ours,
                ours / std::max(arithmetic, bytes / bandwidth));
}

void scaling_tables(const Options& options) {
    const StrandGeometry strands = groom(GroomStyle::curly, options.vertices());
    std::printf(
        "\n## Time by directions: %zu vertices, 256 voxels\n\n| directions | seconds | ns per vertex and direction "
        "|\n|---|---|---|\n",
        strands.vertex_count());
    for (const int directions : {9, 25, 64, 100}) {
        TransmittanceSettings settings;
        settings.directions = directions;
        const double time = time_bake(strands, settings);
        std::printf("| %d | %.2f | %.1f |\n", directions, time,
                    1e9 * time / double(strands.vertex_count()) / directions);
        std::fflush(stdout);
    }
    std::printf(
        "\n## Time by vertices: 100 directions, 256 voxels, wavy grooms\n\n| vertices | seconds | microseconds per "
        "vertex |\n|---|---|---|\n");
    for (const double millions : {0.687532, 0.872756, 1.031268, 1.519823, 3.1}) {
        const auto count = static_cast<std::size_t>(millions * 1e6 * (options.quick ? 0.1 : 1));
        const double time = time_bake(groom(GroomStyle::wavy, count), {});
        std::printf("| %zu | %.2f | %.3f |\n", count, time, 1e6 * time / double(count));
        std::fflush(stdout);
    }
}

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
        std::vector<float> average;
        for (const std::uint32_t v : vertices) average.push_back(baked.average[v]);
        const ErrorBar bar = error_statistics(average, traced);
        std::printf("| %s | %s | %.4f (%.4f to %.4f) | %+.4f | %.2f | %.2f |\n", name.c_str(), method, bar.rmse,
                    bar.rmse_ci95[0], bar.rmse_ci95[1], bar.bias, wall, cpu);
        std::fflush(stdout);
    }
}

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

double peak_megabytes() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmHWM:", 0) == 0) return std::atof(line.c_str() + 6) / 1024;
    return 0;
}

/// The child of memory_table: model and bake alone in a process.
int measure_memory(std::size_t vertices, int voxels) {
    const StrandGeometry strands = groom(GroomStyle::wavy, vertices);
    const double before = peak_megabytes();
    TransmittanceSettings settings;
    settings.voxels = voxels;
    Progress progress;
    const Transmittance baked = bake_transmittance_volume({strands}, settings, progress);
    const double occupied = double(baked.occupied_voxels);
    std::printf("| %zu | %d | %.0f | %.0f | %.1f | %.0f |\n", vertices, voxels, before, peak_megabytes(),
                occupied * 1e-6, (peak_megabytes() - before) * 1e6 / occupied);
    return 0;
}

void memory_table(const char* program, const Options& options) {
    std::printf(
        "\n## Peak memory, without the reference scene\n\n| vertices | voxels | model alone, MB | with bake, MB | "
        "occupied voxels, M | "
        "bytes per occupied voxel |\n|---|---|---|---|---|---|\n");
    std::fflush(stdout);
    for (const auto& [vertices, voxels] :
         {std::pair{3'100'000, 256}, std::pair{3'100'000, 512}, std::pair{1'500'000, 512}}) {
        const std::string command = std::string(program) + " --memory " +
                                    std::to_string(options.quick ? vertices / 10 : vertices) + " " +
                                    std::to_string(voxels);
        if (std::system(command.c_str()) != 0) std::printf("| failed: %s |\n", command.c_str());
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc == 4 && std::strcmp(argv[1], "--memory") == 0)
        return measure_memory(std::strtoull(argv[2], nullptr, 10), std::atoi(argv[3]));
    if (argc == 2 && std::strcmp(argv[1], "--opacity-maps") == 0) {
        std::printf("# Transmittance, %d threads\n", thread_count());
        opacity_map_table();
        return 0;
    }
    if (argc == 2 && std::strcmp(argv[1], "--occluder") == 0) {
        occluder_table({});
        return 0;
    }
    const Options options{argc > 1 && std::strcmp(argv[argc - 1], "--quick") == 0};
    if (argc > 1 && std::strcmp(argv[1], "--directional") == 0) {
        directional_tables(options);
        return 0;
    }
    std::printf("# Transmittance, %d threads\n", thread_count());
    {
        const StrandGeometry curly = groom(GroomStyle::curly, options.vertices());
        std::printf(
            "\n## Speed: %zu vertices x 100 directions, 256 voxels; peers on a sample, scaled\n\n"
            "| model | hairbake, s | Embree packets, s | ratio | VolumeHDDA march, s | ratio "
            "|\n|---|---|---|---|---|---|\n",
            curly.vertex_count());
        speed_table("generated curly", curly);
        speed_table("generated straight", groom(GroomStyle::straight, options.vertices()));
        floors(curly);
    }
    scaling_tables(options);
    memory_table(argv[0], options);
    accuracy_table(options);
    occluder_table(options);
    directional_tables(options);
}
