#include "core/volume/strand_spacing.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/parallel.h"

namespace hairbake {
namespace {

constexpr std::size_t side = 32;  // cells on the longest side of the bounds
constexpr std::size_t vertices_a_task = 4096;

struct Lattice {
    Vec3f low;
    float cell;

    /// One cell in each axis beyond the bounds' upper faces belongs to the last.
    std::size_t cell_of(const Vec3f& p) const {
        const auto place = [&](int axis) {
            const float x = (p[axis] - low[axis]) / cell;
            return static_cast<std::size_t>(std::clamp(x, 0.0f, static_cast<float>(side - 1)));
        };
        return (place(0) * side + place(1)) * side + place(2);
    }
};

/// Marks the cells along a segment, in steps of at most half a cell.
void mark(const Lattice& lattice, const Vec3f& a, const Vec3f& b, double length,
          std::vector<std::atomic<std::uint8_t>>& passed) {
    const int steps = static_cast<int>(length / (0.5 * lattice.cell)) + 1;
    for (int i = 0; i <= steps; ++i) {
        const float s = static_cast<float>(i) / static_cast<float>(steps);
        passed[lattice.cell_of(a + (b - a) * s)].store(1, std::memory_order_relaxed);
    }
}

}  // namespace

double strand_spacing(const StrandGeometry& strands, const Progress& progress) {
    const Vec3f bounds = strands.bounds_max - strands.bounds_min;
    const float longest = std::max({bounds.x, bounds.y, bounds.z});
    if (!(longest > 0)) return 0;
    const Lattice lattice{strands.bounds_min, longest / static_cast<float>(side)};
    std::vector<std::atomic<std::uint8_t>> passed(side * side * side);
    const std::size_t count = strands.vertex_count();
    std::vector<double> lengths((count + vertices_a_task - 1) / vertices_a_task, 0);  // summed in one order
    parallel_for(lengths.size(), 1, [&](std::size_t begin, std::size_t end) {
        progress.check();
        for (std::size_t task = begin; task < end; ++task)
            for (std::size_t v = task * vertices_a_task; v < std::min(count, (task + 1) * vertices_a_task); ++v) {
                if (strands.segments[v] != Segment::solid) continue;
                const Vec3f &a = strands.positions[v], &b = strands.positions[v + 1];
                const double of_segment = length(Vec3d(b) - Vec3d(a));
                lengths[task] += of_segment;
                mark(lattice, a, b, of_segment, passed);
            }
    });
    double total = 0, cells = 0;
    for (const double part : lengths) total += part;
    for (const auto& cell : passed) cells += cell.load(std::memory_order_relaxed);
    if (!(total > 0)) return 0;
    const double cell = lattice.cell;
    return std::sqrt(cells * cell * cell * cell / total);
}

}  // namespace hairbake
