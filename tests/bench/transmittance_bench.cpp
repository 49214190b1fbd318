#include "tests/bench/transmittance_bench.h"

#include <algorithm>
#include <chrono>

#include "core/base/random.h"
#include "core/reference/nearest_strand.h"

namespace hairbake::bench {

double seconds(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double best_of_three(const std::function<void()>& work) {
    double best = 1e9;
    for (int run = 0; run < 3; ++run) best = std::min(best, seconds(work));
    return best;
}

StrandGeometry groom(GroomStyle style, std::size_t vertices) {
    GroomSettings settings;
    settings.style = style;
    settings.vertices = vertices;
    settings.vertices_per_strand = 30;
    return make_strand_geometry(generate_groom(settings), {});
}

double time_bake(const TransmittanceScene& scene, const TransmittanceSettings& settings, Transmittance* result) {
    Progress progress;
    return best_of_three([&] {
        Transmittance baked = bake_transmittance_volume(scene, settings, progress);
        if (result) *result = std::move(baked);
    });
}

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

std::vector<float> at(std::span<const std::uint32_t> vertices, std::span<const float> values) {
    std::vector<float> taken;
    taken.reserve(vertices.size());
    for (const std::uint32_t v : vertices) taken.push_back(values[v]);
    return taken;
}

}  // namespace hairbake::bench
