#include "core/mesh/mesh_topology.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

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

struct Edge {
    std::uint32_t low, high;
    bool upwards;  ///< run through from low to high
};

double signed_volume(const TriangleMesh& mesh) {
    double sum = 0;
    const Vec3d base(mesh.positions[mesh.triangles[0][0]]);  // near the mesh, for the rounding
    for (const auto& t : mesh.triangles)
        sum += dot(Vec3d(mesh.positions[t[0]]) - base,
                   cross(Vec3d(mesh.positions[t[1]]) - base, Vec3d(mesh.positions[t[2]]) - base));
    return sum / 6;
}

}  // namespace

MeshTopology topology_of(const TriangleMesh& mesh) {
    const auto first = welded(mesh.positions);
    std::vector<Edge> edges;
    for (const auto& t : mesh.triangles) {
        const std::uint32_t corner[3] = {first[t[0]], first[t[1]], first[t[2]]};
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t a = corner[c], b = corner[(c + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), a < b});
        }
    }
    const auto key = [](const Edge& e) { return std::pair(e.low, e.high); };
    std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
    MeshTopology topology;
    for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
        std::size_t upwards = 0;
        for (end = begin; end < edges.size() && key(edges[end]) == key(edges[begin]); ++end)
            upwards += edges[end].upwards;
        ++topology.edges;
        if (end - begin == 1)
            ++topology.open_edges;
        else if (end - begin != 2 || upwards != 1)
            ++topology.irregular_edges;
    }
    topology.closed = topology.edges > 0 && topology.open_edges == 0 && topology.irregular_edges == 0;
    topology.inside_out = topology.closed && signed_volume(mesh) < 0;
    return topology;
}

}  // namespace hairbake
