// Whether a mesh encloses a volume.
#pragma once

#include <cstdint>

#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// Connections of the triangles. Positions with equal coordinates count as one, so that a texture seam does not open a
/// mesh. Triangles that thereby lose a side are not counted.
struct MeshTopology {
    std::uint64_t edges = 0;
    std::uint64_t open_edges = 0;       ///< in one triangle only
    std::uint64_t irregular_edges = 0;  ///< in more than two, or run through twice in one direction
    /// Every edge lies in two triangles that run through it both ways.
    bool closed = false;
    /// Closed, and the triangles run clockwise seen from outside (the enclosed volume comes out negative).
    bool inside_out = false;
};

MeshTopology topology_of(const TriangleMesh& mesh);

}  // namespace hairbake
