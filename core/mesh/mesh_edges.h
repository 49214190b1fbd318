// The edges of a mesh, where positions with equal coordinates count as one. Private to core/mesh.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// One side of one triangle.
struct MeshEdge {
    std::uint32_t low, high;  ///< its ends: the smallest indices of the positions with these coordinates
    std::uint32_t triangle;
    bool upwards;  ///< the triangle runs from low to high

    std::pair<std::uint32_t, std::uint32_t> ends() const { return {low, high}; }
};

/// The sides of all triangles, those with the same ends beside each other. A triangle with two corners at one place has
/// none.
std::vector<MeshEdge> sorted_edges(const TriangleMesh& mesh);

}  // namespace hairbake
