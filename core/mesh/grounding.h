// What a point on the surface of an occluder sees of the light: the definition that the bake and the reference share.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// Lengths of the occluder's shadow as parts of `size`, the longest side of the hair's bounds: they do not depend on
/// the voxels, so that bake and reference answer the same question.
struct ShadowScale {
    double size = 1;
    /// Points as deep as this below the surface (a voxel of the default grid) still count as lying on it.
    double reach() const { return size / 256; }
    /// Points on the surface look from this height above it.
    double lift() const { return size / 5000; }
};

/// The longest side of the box of `points`; of the mesh where the points are one; 1 for neither.
ShadowScale shadow_scale(std::span<const Vec3f> points, const TriangleMesh& occluder);

/// A point that counts as lying on the occluder: the roots of hair lie on the scalp, a little above or below it.
struct GroundedPoint {
    std::uint32_t point;  ///< index into the points asked for
    Vec3f origin;         ///< from where it looks: its nearest point of the surface, lifted along the normal
    Vec3f normal;         ///< outward; directions with normal . l <= 0 are blocked
};

/// Those of `points` whose nearest triangle is at most scale.lift() below them (on the side of its normal) or
/// scale.reach() above them, in ascending order. Every other point looks from where it is: from inside a closed mesh
/// it sees nothing. The outside is where a triangle runs counter-clockwise; a closed mesh may be inside out.
/// The same for any thread count. Throws Error(cancelled).
std::vector<GroundedPoint> ground_points(std::span<const Vec3f> points, const TriangleMesh& occluder,
                                         const ShadowScale& scale, Progress& progress);

}  // namespace hairbake
