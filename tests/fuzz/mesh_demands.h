// What every mesh that was read must hold. Shared by the fuzz targets of the mesh formats.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/error.h"
#include "core/mesh/grounding.h"
#include "core/mesh/mesh_file.h"
#include "core/mesh/mesh_fit.h"
#include "core/mesh/mesh_topology.h"
#include "tests/fuzz/demand.h"

namespace hairbake {

inline void check_triangles(const TriangleMesh& mesh) {
    demand(!mesh.triangles.empty(), "a mesh has triangles");
    demand(mesh.normals.size() == mesh.positions.size(), "one normal a position");
    for (const Vec3f& p : mesh.positions) demand(is_finite(p), "positions are finite");
    for (const Vec3f& n : mesh.normals) demand(std::abs(length(Vec3d(n)) - 1) < 1e-5, "normals are of length 1");
    for (const auto& t : mesh.triangles) {
        for (const std::uint32_t i : t) demand(i < mesh.positions.size(), "indices name positions");
        demand(t[0] != t[1] && t[1] != t[2] && t[2] != t[0], "triangles have three positions");
    }
}

inline void check_use(const TriangleMesh& mesh) {
    const MeshTopology topology = topology_of(mesh);
    demand(!topology.closed || topology.open_edges == 0, "a closed mesh has no open edge");
    const std::uint32_t strands[] = {0, static_cast<std::uint32_t>(mesh.positions.size())};
    const MeshFit fit = fit_of(mesh, topology.closed, {mesh.positions, strands});
    demand(fit.inside <= fit.looked_at, "points inside are among those looked at");
    Progress progress;
    const ShadowScale scale = shadow_scale(mesh.positions, mesh);
    for (const GroundedPoint& g : ground_points(mesh.positions, mesh, scale, progress)) {
        demand(is_finite(g.origin), "grounded points are finite");
        demand(std::abs(length(g.normal) - 1) < 1e-4f, "their normals are of length 1");
    }
}

/// Any bytes are refused as bad input, or read as a mesh with valid indices and numbers.
inline void demand_mesh(std::span<const std::byte> bytes) {
    try {
        const TriangleMesh mesh = read_mesh(bytes, "fuzz");
        check_triangles(mesh);
        check_use(mesh);
    } catch (const Error& error) {
        demand(error.kind() == ErrorKind::bad_input, "an input's fault is bad_input");
        demand(error.what()[0] != 0, "a refusal has a message");
    }
}

}  // namespace hairbake
