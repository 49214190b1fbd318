// Speed of the volume method beside its peers and its lower bounds, and by directions and vertices.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/reference/tracer.h"
#include "core/visibility/direction_set.h"
#include "core/volume/density_grid.h"
#include "tests/bench/floor.h"
#include "tests/bench/transmittance_bench.h"
#include "tests/bench/vdb_march.h"

namespace hairbake::bench {
namespace {

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

void speed_row(const std::string& name, const StrandGeometry& strands) {
    Progress progress;
    const double ours = time_bake({strands}, {});
    const auto directions = make_directions(DirectionSet::fibonacci, 100, 1);
    const auto scale = [&](std::size_t sample) { return double(strands.vertex_count()) / double(sample); };

    const StrandScene scene(strands, progress);
    const auto traced = spread_strands(strands, 30'000);
    const double embree =
        best_of_three([&] { trace_transmittance(scene, traced, directions, progress); }) * scale(traced.size());

    const auto file = std::filesystem::temp_directory_path() / "hairbake_bench_density.vdb";
    TransmittanceScene with_density{strands};
    with_density.keep_density = true;
    bake_transmittance_volume(with_density, {}, progress).density->write(file);
    std::vector<Vec3f> positions;
    for (const std::uint32_t v : spread_strands(strands, 6'000)) positions.push_back(strands.positions[v]);
    std::vector<float> average;
    double march = 1e9;
    for (int run = 0; run < 3; ++run)
        march = std::min(march, time_vdb_march(file, positions, directions, average) * scale(positions.size()));
    std::filesystem::remove(file);

    std::printf("| %s | %.2f | %.0f | %.0f | %.0f | %.0f |\n", name.c_str(), ours, embree, embree / ours, march,
                march / ours);
    std::fflush(stdout);
}

void floors(const StrandGeometry& strands) {
    const double terms = double(strands.vertex_count()) * 100;
    const double bandwidth = memory_bandwidth();
    Transmittance baked;
    const double ours = time_bake({strands}, {}, &baked);
    // Four directions share one pass. A pass reads 16 bytes and reads and writes 16 bytes of sums a vertex, and reads
    // 12 bytes of tensor for every voxel of an occupied brick; the rays stay in the cache.
    const double bytes = terms / 4 * (16 + 2 * 16) + 25.0 * 12 * double(baked.occupied_voxels);
    std::printf("\n## Floors: %zu vertices x 100 directions\n\n", strands.vertex_count());
    std::printf("memory: %.2f GB at least at a measured %.1f GB/s: %.3f s\n", bytes * 1e-9, bandwidth * 1e-9,
                bytes / bandwidth);
    const double arithmetic = arithmetic_time(static_cast<std::size_t>(terms));
    std::printf("arithmetic: a gather, an exp and four sums for each vertex and direction: %.3f s\n", arithmetic);
    std::printf("whole stage: %.2f s, %.1f times the larger floor\n", ours,
                ours / std::max(arithmetic, bytes / bandwidth));
}

void scaling_tables(const BenchOptions& options) {
    const StrandGeometry strands = groom(GroomStyle::curly, options.vertices());
    std::printf(
        "\n## Time by directions: %zu vertices, 256 voxels\n\n| directions | seconds | ns per vertex and direction "
        "|\n|---|---|---|\n",
        strands.vertex_count());
    for (const int directions : {9, 25, 64, 100}) {
        TransmittanceSettings settings;
        settings.directions = directions;
        const double time = time_bake({strands}, settings);
        std::printf("| %d | %.2f | %.1f |\n", directions, time,
                    1e9 * time / double(strands.vertex_count()) / directions);
        std::fflush(stdout);
    }
    std::printf(
        "\n## Time by vertices: 100 directions, 256 voxels, wavy grooms\n\n| vertices | seconds | microseconds per "
        "vertex |\n|---|---|---|\n");
    for (const double millions : {0.687532, 0.872756, 1.031268, 1.519823, 3.1}) {
        const auto count = static_cast<std::size_t>(millions * 1e6 * (options.quick ? 0.1 : 1));
        const StrandGeometry wavy = groom(GroomStyle::wavy, count);
        const double time = time_bake({wavy}, {});
        std::printf("| %zu | %.2f | %.3f |\n", count, time, 1e6 * time / double(count));
        std::fflush(stdout);
    }
}

}  // namespace

void speed_tables(const BenchOptions& options) {
    const StrandGeometry curly = groom(GroomStyle::curly, options.vertices());
    std::printf(
        "\n## Speed: %zu vertices x 100 directions, 256 voxels; peers on a sample, scaled\n\n"
        "| model | hairbake, s | Embree packets, s | ratio | VolumeHDDA march, s | ratio "
        "|\n|---|---|---|---|---|---|\n",
        curly.vertex_count());
    speed_row("generated curly", curly);
    speed_row("generated straight", groom(GroomStyle::straight, options.vertices()));
    floors(curly);
    scaling_tables(options);
}

}  // namespace hairbake::bench
