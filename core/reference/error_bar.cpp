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

/// Turns by `angle` about the unit vector `axis` (Rodrigues).
Vec3d turned(const Vec3d& v, const Vec3d& axis, double angle) {
    return v * std::cos(angle) + cross(axis, v) * std::sin(angle) + axis * (dot(axis, v) * (1 - std::cos(angle)));
}

std::vector<float> at(std::span<const float> values, std::span<const std::uint32_t> places) {
    std::vector<float> some;
    some.reserve(places.size());
    for (const std::uint32_t place : places) some.push_back(values[place]);
    return some;
}

TracedHalves at(const TracedHalves& traced, std::span<const std::uint32_t> places) {
    return {at(traced.first, places), at(traced.second, places)};
}

}  // namespace

std::vector<float> TracedHalves::mean() const {
    std::vector<float> mean(first.size());
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] = 0.5f * (first[k] + second[k]);
    return mean;
}

ErrorFigures error_statistics(std::span<const float> baked, const TracedHalves& traced) {
    HAIRBAKE_ASSERT(baked.size() == traced.first.size() && baked.size() == traced.second.size());
    ErrorFigures figures;
    figures.vertices = static_cast<std::uint32_t>(baked.size());
    if (baked.empty()) return figures;
    double sum = 0, sum2 = 0, sum4 = 0, noise2 = 0;
    for (std::size_t k = 0; k < baked.size(); ++k) {
        const double first(traced.first[k]), second(traced.second[k]), e = double(baked[k]) - 0.5 * (first + second);
        sum += e;
        sum2 += e * e;
        sum4 += e * e * e * e;
        noise2 += (first - second) * (first - second) / 4;
    }
    const double n = double(baked.size()), mean_square = sum2 / n;
    noise2 /= n;
    figures.noise = std::sqrt(noise2);
    figures.bias = sum / n;
    const auto root = [&](double square) { return std::sqrt(std::max(0.0, square - noise2)); };
    figures.rmse = root(mean_square);
    const double bias_half = 1.96 * std::sqrt(std::max(0.0, mean_square - figures.bias * figures.bias) / n);
    const double square_half = 1.96 * std::sqrt(std::max(0.0, sum4 / n - mean_square * mean_square) / n);
    figures.bias_ci95 = {figures.bias - bias_half, figures.bias + bias_half};
    figures.rmse_ci95 = {root(mean_square - square_half), root(mean_square + square_half)};
    return figures;
}

ErrorFigures error_statistics(std::span<const float> baked, std::span<const float> traced) {
    const std::vector<float> both(traced.begin(), traced.end());
    return error_statistics(baked, TracedHalves{both, both});
}

std::array<std::vector<Vec3d>, 2> make_reference_directions() {
    // The axes and angles are arbitrary. What counts is that no multiple of a Fibonacci set's own step is among them.
    const std::array<Vec3d, 2> axes{normalized(Vec3d{1, 2, -3}), normalized(Vec3d{-5, 1, 4})};
    const std::array<double, 2> angles{1.234, 2.718};
    std::array<std::vector<Vec3d>, 2> halves;
    for (std::size_t half = 0; half < halves.size(); ++half)
        for (const Vec3d& l : make_directions(DirectionSet::fibonacci, reference_directions / 2, 0))
            halves[half].push_back(normalized(turned(l, axes[half], angles[half])));
    return halves;
}

TracedHalves trace_reference(const StrandScene& scene, std::span<const std::uint32_t> vertices, Progress& progress) {
    const auto directions = make_reference_directions();
    ProgressPart first = progress.part(0, 0.5), second = progress.part(0.5, 1);
    TracedHalves traced;
    traced.first = trace_transmittance(scene, vertices, directions[0], first);
    traced.second = trace_transmittance(scene, vertices, directions[1], second);
    return traced;
}

ErrorReference::ErrorReference(const StrandScene& scene, int count, std::uint64_t seed, Progress& progress)
    : vertex_count_(scene.strands().vertex_count()) {
    HAIRBAKE_ASSERT(count >= 0);
    const auto drawn = draw_vertices(vertex_count_, static_cast<std::size_t>(count), seed);
    const std::vector<float> distance = distance_to_other_strands(scene.strands(), drawn, 1);
    for (std::size_t k = 0; k < drawn.size(); ++k) {
        if (!(distance[k] >= 0)) continue;
        if (distance[k] >= 1) clear_.push_back(static_cast<std::uint32_t>(outside_.size()));
        outside_.push_back(drawn[k]);
    }
    inside_strand_ = static_cast<std::uint32_t>(drawn.size() - outside_.size());
    traced_ = trace_reference(scene, outside_, progress);
}

ErrorBar ErrorReference::compare(std::span<const float> average) const {
    HAIRBAKE_ASSERT(average.size() == vertex_count_);
    const std::vector<float> baked = at(average, outside_);
    ErrorBar bar;
    bar.outside = error_statistics(baked, traced_);
    bar.clear = error_statistics(at(baked, clear_), at(traced_, clear_));
    bar.inside_strand = inside_strand_;
    bar.directions = reference_directions;
    return bar;
}

ErrorBar measure_error(const StrandScene& scene, std::span<const float> average, int count, std::uint64_t seed,
                       Progress& progress) {
    return ErrorReference(scene, count, seed, progress).compare(average);
}

}  // namespace hairbake
