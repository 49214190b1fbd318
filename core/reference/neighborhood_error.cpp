#include "core/reference/neighborhood_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/base/assert.h"
#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/reference/nearest_strand.h"
#include "core/reference/tracer.h"
#include "core/visibility/direction_set.h"

namespace hairbake {
namespace {

using Vertices = std::vector<std::uint32_t>;

/// Draws until `count` vertices are visible from their own direction, at most 16 times as many.
Vertices draw_visible(const StrandScene& scene, std::size_t count, std::uint64_t seed, Progress& progress) {
    const auto views = make_directions(DirectionSet::fibonacci, 26, 0);
    const auto vertex_count = static_cast<double>(scene.strands().vertex_count());
    Random random(seed);
    Vertices visible;
    for (std::size_t round = 0; round < 16 && visible.size() < count; ++round) {
        Vertices drawn(count);
        for (auto& v : drawn) v = static_cast<std::uint32_t>(random.next() * vertex_count);
        const Vec3d view[] = {views[round % views.size()]};
        const std::vector<float> open = trace_transmittance(scene, drawn, view, progress);
        for (std::size_t i = 0; i < drawn.size() && visible.size() < count; ++i)
            if (open[i] > 0.5f) visible.push_back(drawn[i]);
    }
    std::sort(visible.begin(), visible.end());
    visible.erase(std::unique(visible.begin(), visible.end()), visible.end());
    return visible;
}

/// The vertices nearest to `centre`, itself among them; of equal distances the first.
Vertices nearest_to(const StrandGeometry& strands, std::uint32_t centre) {
    const Vec3f c = strands.positions[centre];
    std::vector<std::pair<float, std::uint32_t>> distances(strands.vertex_count());
    for (std::uint32_t v = 0; v < distances.size(); ++v) {
        const Vec3f d = strands.positions[v] - c;
        distances[v] = {dot(d, d), v};
    }
    const std::size_t size = std::min(neighborhood_size, distances.size());
    std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(size - 1), distances.end());
    Vertices nearest;
    for (std::size_t i = 0; i < size; ++i) nearest.push_back(distances[i].second);
    std::sort(nearest.begin(), nearest.end());
    return nearest;
}

/// Removes the vertices that lie inside other strands. One search serves all neighbourhoods: it visits every segment.
void keep_outside(const StrandGeometry& strands, std::vector<Vertices>& neighborhoods) {
    Vertices vertices;
    for (const Vertices& some : neighborhoods) vertices.insert(vertices.end(), some.begin(), some.end());
    const std::vector<float> distance = distance_to_other_strands(strands, vertices, 1);
    std::size_t place = 0;
    for (Vertices& some : neighborhoods) std::erase_if(some, [&](std::uint32_t) { return distance[place++] < 0; });
}

/// [neighbourhood]: its vertices outside other strands.
std::vector<Vertices> find_neighborhoods(const StrandScene& scene, const Vertices& centres, const Progress& progress) {
    std::vector<Vertices> all(centres.size());
    parallel_for(centres.size(), 1, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t i = begin; i < end; ++i) all[i] = nearest_to(scene.strands(), centres[i]);
    });
    keep_outside(scene.strands(), all);
    std::erase_if(all, [](const Vertices& vertices) { return vertices.empty(); });
    return all;
}

/// Mean of `value` over consecutive runs as long as the neighbourhoods.
template <class Value>
std::vector<double> means(const std::vector<Vertices>& neighborhoods, const Value& value) {
    std::vector<double> result;
    std::size_t place = 0;
    for (const Vertices& vertices : neighborhoods) {
        double sum = 0;
        for (const std::uint32_t v : vertices) sum += value(place++, v);
        result.push_back(sum / double(vertices.size()));
    }
    return result;
}

}  // namespace

NeighborhoodFigures neighborhood_figures(std::span<const double> baked, std::span<const double> traced) {
    HAIRBAKE_ASSERT(baked.size() == traced.size());
    NeighborhoodFigures figures;
    const auto n = static_cast<double>(baked.size());
    const double mean_x = std::accumulate(baked.begin(), baked.end(), 0.0) / n;
    const double mean_y = std::accumulate(traced.begin(), traced.end(), 0.0) / n;
    if (baked.size() < 3 || !(mean_y > 0)) return figures;
    double xx = 0, xy = 0, yy = 0, squares = 0;
    for (std::size_t i = 0; i < baked.size(); ++i) {
        const double x = baked[i] - mean_x, y = traced[i] - mean_y;
        xx += x * x;
        xy += x * y;
        yy += y * y;
        squares += (baked[i] - traced[i]) * (baked[i] - traced[i]);
    }
    figures.rmse = std::sqrt(squares / n) / mean_y;
    figures.bias = (mean_x - mean_y) / mean_y;
    const double variance = std::max(0.0, squares / n - (mean_x - mean_y) * (mean_x - mean_y));
    const double half = 1.96 * std::sqrt(variance / n) / mean_y;
    figures.bias_ci95 = {figures.bias - half, figures.bias + half};
    if (!(xx > 0)) return figures;
    figures.slope = xy / xx;
    const double slope_half = 1.96 * std::sqrt(std::max(0.0, yy - figures.slope * xy) / (n - 2) / xx);
    figures.slope_ci95 = {figures.slope - slope_half, figures.slope + slope_half};
    return figures;
}

NeighborhoodError measure_neighborhoods(const StrandScene& scene, std::span<const Vec3d> directions,
                                        const DirectionWeights& light, std::span<const float> baked, int count,
                                        std::uint64_t seed, Progress& progress) {
    HAIRBAKE_ASSERT(count > 0 && light.components == 1 && baked.size() == scene.strands().vertex_count());
    NeighborhoodError error;
    if (baked.empty()) return error;
    ProgressPart searching = progress.part(0, 0.2), tracing = progress.part(0.2, 0.6),
                 averaging = progress.part(0.6, 1);
    const auto neighborhoods =
        find_neighborhoods(scene, draw_visible(scene, static_cast<std::size_t>(count), seed, searching), progress);
    Vertices vertices;
    for (const Vertices& some : neighborhoods) vertices.insert(vertices.end(), some.begin(), some.end());
    const std::vector<float> seen = trace_weighted(scene, vertices, directions, light, tracing);
    const std::vector<float> average =
        trace_transmittance(scene, vertices, make_directions(DirectionSet::fibonacci, 100, 0), averaging);
    const auto unblocked = [&](std::uint32_t v) {
        double sum = 0;
        for (std::size_t k = 0; k < directions.size(); ++k) sum += double(*light.of(light.rows[v], k));
        return sum;
    };
    const auto traced = means(neighborhoods, [&](std::size_t i, std::uint32_t) { return double(seen[i]); });
    error.neighborhoods = static_cast<std::uint32_t>(neighborhoods.size());
    error.vertices = static_cast<std::uint32_t>(vertices.size());
    error.effective = neighborhood_figures(
        means(neighborhoods, [&](std::size_t, std::uint32_t v) { return double(baked[v]); }), traced);
    error.average = neighborhood_figures(
        means(neighborhoods, [&](std::size_t i, std::uint32_t v) { return double(average[i]) * unblocked(v); }),
        traced);
    return error;
}

}  // namespace hairbake
