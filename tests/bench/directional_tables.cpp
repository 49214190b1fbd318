// Harmonics, bent cones and receivers: their time, and their accuracy against Embree.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "core/hair/hair_file.h"
#include "core/reference/tracer.h"
#include "core/sample/head_mesh.h"
#include "core/visibility/direction_set.h"
#include "tests/bench/transmittance_bench.h"
#include "tests/support/shared_data.h"

namespace hairbake::bench {
namespace {

/// Time of harmonics and bent cones beside the time of A alone. All run in turn, best of three.
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

/// Roots of the mean squares, in degrees.
struct ConeErrors {
    double axis = 0, half_angle = 0;
};

/// Errors of the bent cones at vertices that see at least a tenth of the sky. Elsewhere too few rays decide the cone.
ConeErrors cone_errors(const Transmittance& baked, const DirectionalMeans& traced,
                       std::span<const std::uint32_t> vertices) {
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
    return {degrees * std::sqrt(axis / double(scored)), degrees * std::sqrt(angle / double(scored))};
}

/// Coefficients against the traced ones, by band: error and size of a coefficient, root of the mean square over the
/// scored vertices and the band's m.
void sh_accuracy(const std::string& name, const StrandGeometry& strands, const BenchOptions& options) {
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
    const ConeErrors cones = cone_errors(baked, traced, vertices);
    std::printf(" %.1f | %.1f |\n", cones.axis, cones.half_angle);
    std::fflush(stdout);
}

void receiver_accuracy(const std::string& name, const StrandGeometry& strands, const TriangleMesh& receiver,
                       const BenchOptions& options) {
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

}  // namespace

void directional_tables(const BenchOptions& options) {
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

}  // namespace hairbake::bench
