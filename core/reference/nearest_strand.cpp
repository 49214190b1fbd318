#include "core/reference/nearest_strand.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <unordered_map>

#include "core/base/parallel.h"
#include "core/reference/own_strand.h"

namespace hairbake {
namespace {

/// Distance from p to the surface of a segment: to its axis, less the radius at the foot point.
float surface_distance(const StrandGeometry& strands, std::uint32_t segment, const Vec3f& p) {
    const Vec3d a(strands.positions[segment]), axis = Vec3d(strands.positions[segment + 1]) - a, to_p = Vec3d(p) - a;
    const double s = std::clamp(dot(to_p, axis) / dot(axis, axis), 0.0, 1.0);
    const double width = (1 - s) * double(strands.widths[segment]) + s * double(strands.widths[segment + 1]);
    return static_cast<float>(length(to_p - s * axis) - 0.5 * width);
}

/// The queried vertices in a lattice of cells. A vertex is listed in every cell that its reach touches, so that the
/// cells along a segment list every vertex near it.
class QueryCells {
public:
    QueryCells(const StrandGeometry& strands, std::span<const std::uint32_t> vertices, float limit)
        : low_(strands.bounds_min) {
        const Vec3f side = strands.bounds_max - strands.bounds_min;
        const float thickest = *std::max_element(strands.widths.begin(), strands.widths.end());
        for (const std::uint32_t v : vertices) reach_ = std::max(reach_, limit * strands.widths[v] + 0.5f * thickest);
        cell_ = std::max({reach_, std::max({side.x, side.y, side.z}) / 126, 1e-30f});
        occupied_.resize(kSide * kSide * kSide);
        for (std::uint32_t k = 0; k < vertices.size(); ++k) {
            const Vec3f p = strands.positions[vertices[k]];
            for_each_cell(p - Vec3f(reach_), p + Vec3f(reach_), [&](std::uint32_t cell) {
                occupied_[cell] = 1;
                queries_[cell].push_back(k);
            });
        }
    }

    float cell() const { return cell_; }

    /// Calls visit(k) for the queries listed in the cells of the box.
    template <class Visit>
    void for_each_query(const Vec3f& low, const Vec3f& high, const Visit& visit) const {
        for_each_cell(low, high, [&](std::uint32_t cell) {
            if (!occupied_[cell]) return;
            for (const std::uint32_t k : queries_.at(cell)) visit(k);
        });
    }

private:
    static constexpr std::uint32_t kSide = 128;

    std::uint32_t coordinate(float x, float low) const {
        return static_cast<std::uint32_t>(std::clamp((x - low) / cell_ + 1, 0.0f, float(kSide - 1)));
    }

    template <class Visit>
    void for_each_cell(const Vec3f& low, const Vec3f& high, const Visit& visit) const {
        for (std::uint32_t i = coordinate(low.x, low_.x); i <= coordinate(high.x, low_.x); ++i)
            for (std::uint32_t j = coordinate(low.y, low_.y); j <= coordinate(high.y, low_.y); ++j)
                for (std::uint32_t k = coordinate(low.z, low_.z); k <= coordinate(high.z, low_.z); ++k)
                    visit((i * kSide + j) * kSide + k);
    }

    Vec3f low_;
    float reach_ = 0, cell_ = 1;
    std::vector<std::uint8_t> occupied_;
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> queries_;
};

Vec3f smaller(const Vec3f& a, const Vec3f& b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3f larger(const Vec3f& a, const Vec3f& b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

void lower(std::atomic<float>& value, float to) {
    float now = value.load(std::memory_order_relaxed);
    while (to < now && !value.compare_exchange_weak(now, to, std::memory_order_relaxed)) {
    }
}

}  // namespace

std::vector<float> distance_to_other_strands(const StrandGeometry& strands, std::span<const std::uint32_t> vertices,
                                             float limit) {
    if (vertices.empty()) return {};
    const QueryCells cells(strands, vertices, limit);
    std::vector<std::atomic<float>> nearest(vertices.size());
    for (std::size_t k = 0; k < nearest.size(); ++k) nearest[k] = limit * strands.widths[vertices[k]];
    parallel_for(strands.vertex_count(), 16384, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (strands.segments[i] != Segment::solid) continue;
            const auto segment = static_cast<std::uint32_t>(i);
            const Vec3f start = strands.positions[i], whole = strands.positions[i + 1] - start;
            // In steps of a cell at most, so that the boxes stay small along a diagonal.
            const int steps = static_cast<int>(length(whole) / cells.cell()) + 1;
            for (int step = 0; step < steps; ++step) {
                const Vec3f a = start + whole * (float(step) / float(steps));
                const Vec3f b = start + whole * (float(step + 1) / float(steps));
                cells.for_each_query(smaller(a, b), larger(a, b), [&](std::uint32_t k) {
                    const std::uint32_t v = vertices[k];
                    const OwnSegments own = own_segments(strands, v);
                    if (!own.contains(segment) && !enters_from_inside(strands, v, own, segment, Vec3f(0)))
                        lower(nearest[k], surface_distance(strands, segment, strands.positions[v]));
                });
            }
        }
    });
    std::vector<float> distances(vertices.size());
    for (std::size_t k = 0; k < distances.size(); ++k) distances[k] = nearest[k] / strands.widths[vertices[k]];
    return distances;
}

}  // namespace hairbake
