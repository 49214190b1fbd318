#include "core/mesh/mesh_topology.h"

#include <vector>

#include "core/mesh/mesh_edges.h"

namespace hairbake {
namespace {

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
    const std::vector<MeshEdge> edges = sorted_edges(mesh);
    MeshTopology topology;
    for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
        std::size_t upwards = 0;
        for (end = begin; end < edges.size() && edges[end].ends() == edges[begin].ends(); ++end)
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
