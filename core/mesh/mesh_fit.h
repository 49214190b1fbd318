// How a mesh lies to the hair: finds likely errors of unit or frame.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// The points of hair, in the mesh's unit and frame.
struct HairPoints {
    std::span<const Vec3f> positions;             ///< [V]
    std::span<const std::uint32_t> strand_begin;  ///< [S + 1] or empty; the first point of a strand is its root
};

struct MeshFit {
    std::uint64_t looked_at = 0;  ///< points of the hair, evenly chosen; at most 100,000
    std::uint64_t inside = 0;     ///< of them, deeper inside the mesh than counts as lying on it; 0 for an open mesh
    std::vector<std::string> warnings;  ///< each continues "the mesh: ..."
};

/// Warns where
/// - at least half of the points are inside the mesh: in a closed one A is 0 there; inside an open one (a head that ends
///   at the neck) is where it winds round a point by more than a half;
/// - the roots are not on the surface, and would be four times nearer (and near it, within 2 % of the longest side of the
///   hair's box, or 0.2 % of the mesh's) if the mesh were turned by 90 degrees about x (z-up for y-up) or scaled by a
///   usual factor of units, or both. The median of the roots counts; they are on the surface within a tenth of "near";
/// - or, where no such change helps and the roots are not near, the mesh is 30 times larger or smaller than the hair, or
///   farther from it than either is large.
/// A mesh near the roots has the right unit, whatever its size.
///
///   mesh:   oriented (mesh_orientation.h)
///   closed: whether it encloses a volume (MeshTopology::closed)
/// The same for any thread count.
MeshFit fit_of(const TriangleMesh& mesh, bool closed, const HairPoints& hair);

/// The warnings of fit_of() about unit and frame, for a mesh that stops no light.
std::vector<std::string> place_warnings(const TriangleMesh& mesh, const HairPoints& hair);

}  // namespace hairbake
