#include "core/reference/error_bar.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/base/assert.h"
#include "core/base/random.h"
#include "core/reference/nearest_strand.h"
#include "core/reference/tracer.h"
#include "core/visibility/direction_set.h"

namespace hairbake {
namespace {

std::vector<std::uint32_t> draw_vertices(std::size_t vertex_count, std::size_t count, std::uint64_t seed) {
    std::vector<std::uint32_t> drawn(std::min(vertex_count, count));
    if (vertex_count <= count) {
        std::iota(drawn.begin(), drawn.end(), 0u);
        return drawn;
    }
    Random random(seed);
    for (auto& v : drawn) v = static_cast<std::uint32_t>(random.next() * static_cast<double>(vertex_count));
    std::sort(drawn.begin(), drawn.end());
    return drawn;
}

/// Those of `vertices` that are not inside another strand.
std::vector<std::uint32_t> outside_strands(const StrandScene& scene, std::span<const std::uint32_t> vertices) {
    const std::vector<float> distance = distance_to_other_strands(scene.strands(), vertices, 1);
    std::vector<std::uint32_t> outside;
    for (std::size_t k = 0; k < vertices.size(); ++k)
        if (distance[k] >= 0) outside.push_back(vertices[k]);
    return outside;
}

}  // namespace

ErrorBar error_statistics(std::span<const float> baked, std::span<const float> traced) {
    HAIRBAKE_ASSERT(baked.size() == traced.size());
    ErrorBar bar;
    bar.vertices = static_cast<std::uint32_t>(baked.size());
    if (baked.empty()) return bar;
    double sum = 0, sum2 = 0, sum4 = 0;
    for (std::size_t k = 0; k < baked.size(); ++k) {
        const double e = double(baked[k]) - double(traced[k]);
        sum += e;
        sum2 += e * e;
        sum4 += e * e * e * e;
    }
    const double n = double(baked.size()), mean_square = sum2 / n;
    bar.bias = sum / n;
    bar.rmse = std::sqrt(mean_square);
    const double bias_half = 1.96 * std::sqrt(std::max(0.0, mean_square - bar.bias * bar.bias) / n);
    const double square_half = 1.96 * std::sqrt(std::max(0.0, sum4 / n - mean_square * mean_square) / n);
    bar.bias_ci95 = {bar.bias - bias_half, bar.bias + bias_half};
    bar.rmse_ci95 = {std::sqrt(std::max(0.0, mean_square - square_half)), std::sqrt(mean_square + square_half)};
    return bar;
}

ErrorBar measure_error(const StrandScene& scene, std::span<const float> average, int count, std::uint64_t seed,
                       Progress& progress) {
    HAIRBAKE_ASSERT(count >= 0 && average.size() == scene.strands().vertex_count());
    constexpr int directions = 1024;
    const auto drawn = draw_vertices(average.size(), static_cast<std::size_t>(count), seed);
    const auto vertices = outside_strands(scene, drawn);
    const auto traced =
        trace_transmittance(scene, vertices, make_directions(DirectionSet::fibonacci, directions, 0), progress);
    std::vector<float> baked;
    baked.reserve(vertices.size());
    for (const std::uint32_t v : vertices) baked.push_back(average[v]);
    ErrorBar bar = error_statistics(baked, traced);
    bar.inside_strand = static_cast<std::uint32_t>(drawn.size() - vertices.size());
    bar.directions = directions;
    return bar;
}

}  // namespace hairbake
