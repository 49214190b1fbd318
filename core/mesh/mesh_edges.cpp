#include "core/mesh/mesh_edges.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace hairbake {
namespace {

/// For each position the smallest index of those equal to it.
std::vector<std::uint32_t> welded(const std::vector<Vec3f>& positions) {
    std::vector<std::uint32_t> order(positions.size()), first(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](std::uint32_t i) { return std::tuple(positions[i].x, positions[i].y, positions[i].z); };
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
    for (std::size_t k = 0; k < order.size(); ++k)
        first[order[k]] = k > 0 && key(order[k - 1]) == key(order[k]) ? first[order[k - 1]] : order[k];
    return first;
}

}  // namespace

std::vector<MeshEdge> sorted_edges(const TriangleMesh& mesh) {
    const auto first = welded(mesh.positions);
    std::vector<MeshEdge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (std::uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
        const auto& t = mesh.triangles[triangle];
        const std::uint32_t corner[3] = {first[t[0]], first[t[1]], first[t[2]]};
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t a = corner[c], b = corner[(c + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), triangle, a < b});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const MeshEdge& a, const MeshEdge& b) {
        return a.ends() != b.ends() ? a.ends() < b.ends() : a.triangle < b.triangle;
    });
    return edges;
}

}  // namespace hairbake
