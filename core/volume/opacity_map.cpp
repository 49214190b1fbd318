#include "core/volume/opacity_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/volume/texel_walk.h"

namespace hairbake {
namespace {

constexpr float no_hair = std::numeric_limits<float>::infinity();

/// Coverage of the whole segment i, in texel areas: width times length across the map times opacity.
float coverage_of(const StrandGeometry& strands, const OpacityView& view, std::span<const LightPoint> points,
                  std::size_t i) {
    if (strands.segments[i] != Segment::solid) return 0;
    const float opacity = 0.5f * (strands.opacities[i] + strands.opacities[i + 1]);
    const float width = 0.5f * (strands.widths[i] + strands.widths[i + 1]) * static_cast<float>(view.scale);
    const float x = points[i + 1].x - points[i].x, y = points[i + 1].y - points[i].y;
    return opacity * width * std::sqrt(x * x + y * y);
}

/// Share of the piece between the depths a and b that lies before `end`.
float share_before(float end, float a, float b) {
    const float near = std::min(a, b), far = std::max(a, b);
    if (end >= far) return 1;
    return end > near ? (end - near) / (far - near) : 0;
}

float depth_at(const LightPoint& a, const LightPoint& b, float t) { return a.z + t * (b.z - a.z); }

}  // namespace

std::uint64_t OpacityMap::bytes(const OpacityMapSettings& settings) {
    const auto side = static_cast<std::uint64_t>(settings.resolution);
    return side * side * 4 * (1 + static_cast<std::uint64_t>(settings.layers));
}

void OpacityMap::draw(const OpacityView& view, const StrandGeometry& strands, std::span<const LightPoint> points,
                      const Progress& progress) {
    view_ = &view;
    const std::size_t layers = view.layer_end.size();
    texels_.assign(place(0, view.height), 0);
    for (std::size_t at = 0; at < texels_.size(); at += 1 + layers) texels_[at] = no_hair;
    const auto for_each_piece = [&](const auto& visit) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (i % 65536 == 0) progress.check();
            const float coverage = coverage_of(strands, view, points, i);
            if (!(coverage > 0)) continue;
            const LightPoint &a = points[i], &b = points[i + 1];
            walk_texels(a, b, [&](int x, int y, float t0, float t1) {
                visit(&texels_[place(x, y)], (t1 - t0) * coverage, depth_at(a, b, t0), depth_at(a, b, t1));
                return true;
            });
        }
    };
    for_each_piece([](float* texel, float, float z0, float z1) { texel[0] = std::min({texel[0], z0, z1}); });
    for_each_piece([&](float* texel, float coverage, float z0, float z1) {
        for (std::size_t k = 0; k + 1 < layers; ++k)
            texel[1 + k] += coverage * share_before(texel[0] + view.layer_end[k], z0, z1);
        texel[layers] += coverage;  // the last layer receives everything
    });
}

/// The four texels about a point, their weights in the blend, and the place of the point on each texel's curve.
struct OpacityMap::Footprint {
    struct Texel {
        float weight = 0;   ///< 0 where the texel does not count
        float before = -1;  ///< absolute depth where the point's layer begins, and where it ends
        float end = 0;
        float inside = 0;       ///< share of the layer that lies before the point
        std::size_t layer = 0;  ///< the point's
        std::size_t last_layer = 0;
    };
    int x = 0, y = 0;  ///< of the first texel
    std::array<Texel, 4> texels;

    /// Index of the texel among the four, or -1.
    int index(int tx, int ty) const {
        const int dx = tx - x, dy = ty - y;
        return (dx & ~1) == 0 && (dy & ~1) == 0 ? 2 * dy + dx : -1;
    }
};

OpacityMap::Footprint OpacityMap::footprint(const LightPoint& p) const {
    Footprint footprint;
    const auto near_map = [](float x, int size) { return x > -1 && x < static_cast<float>(size + 1); };
    if (!near_map(p.x, view_->width) || !near_map(p.y, view_->height)) return footprint;
    footprint.x = static_cast<int>(std::floor(p.x - 0.5f));
    footprint.y = static_cast<int>(std::floor(p.y - 0.5f));
    const float fx = p.x - 0.5f - static_cast<float>(footprint.x), fy = p.y - 0.5f - static_cast<float>(footprint.y);
    const auto& layer_end = view_->layer_end;
    for (int i = 0; i < 4; ++i) {
        const int x = footprint.x + (i & 1), y = footprint.y + (i >> 1);
        if (x < 0 || y < 0 || x >= view_->width || y >= view_->height) continue;
        const float first = texel(x, y)[0], behind = p.z - first;
        if (!(behind > 0)) continue;  // in front of the first hair, or no hair
        auto& t = footprint.texels[static_cast<std::size_t>(i)];
        t.weight = (i & 1 ? fx : 1 - fx) * (i >> 1 ? fy : 1 - fy);
        const auto found = std::upper_bound(layer_end.begin(), layer_end.end() - 1, behind);
        t.layer = static_cast<std::size_t>(found - layer_end.begin());
        t.last_layer = layer_end.size() - 1;
        const float begin = t.layer > 0 ? layer_end[t.layer - 1] : 0, thickness = *found - begin;
        t.inside = thickness > 0 ? std::min(1.0f, (behind - begin) / thickness) : 1;
        t.before = first + begin;
        t.end = first + *found;
    }
    return footprint;
}

float OpacityMap::own_depth(const StrandGeometry& strands, std::span<const LightPoint> points, std::uint32_t v,
                            const Footprint& footprint) const {
    float depth = 0;
    // Adds the piece from vertex `from` to its neighbour `to`; returns whether `to` lies in the four texels as well.
    const auto stays = [&](std::uint32_t from, std::uint32_t to) {
        const float coverage = coverage_of(strands, *view_, points, std::min(from, to));
        const LightPoint &a = points[from], &b = points[to];
        return walk_texels(a, b, [&](int x, int y, float t0, float t1) {
            const int index = footprint.index(x, y);
            if (index < 0) return false;
            const auto& texel = footprint.texels[static_cast<std::size_t>(index)];
            if (texel.weight == 0) return true;
            const float z0 = depth_at(a, b, t0), z1 = depth_at(a, b, t1);
            const float before = texel.layer > 0 ? share_before(texel.before, z0, z1) : 0;
            const float end = texel.layer == texel.last_layer ? 1 : share_before(texel.end, z0, z1);
            depth += texel.weight * (t1 - t0) * coverage * (before + texel.inside * (end - before));
            return true;
        });
    };
    for (std::uint32_t i = v; strands.segments[i] != Segment::none && stays(i, i + 1);) ++i;
    for (std::uint32_t i = v; i > 0 && strands.segments[i - 1] != Segment::none && stays(i, i - 1);) --i;
    return depth;
}

float OpacityMap::optical_depth(const LightPoint& point) const {
    const Footprint around = footprint(point);
    float depth = 0;
    for (int i = 0; i < 4; ++i) {
        const auto& t = around.texels[static_cast<std::size_t>(i)];
        if (t.weight == 0) continue;
        const float* layers = texel(around.x + (i & 1), around.y + (i >> 1)) + 1;
        const float before = t.layer > 0 ? layers[t.layer - 1] : 0;
        depth += t.weight * (before + t.inside * (layers[t.layer] - before));
    }
    return depth;
}

float OpacityMap::optical_depth(const StrandGeometry& strands, std::span<const LightPoint> points,
                                std::uint32_t v) const {
    const Footprint around = footprint(points[v]);
    return std::max(0.0f, optical_depth(points[v]) - own_depth(strands, points, v, around));
}

}  // namespace hairbake
