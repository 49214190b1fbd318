// Visibility of points on the surface of an occluder. The bake and the reference share this definition.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// Lengths of the occluder's shadow as fractions of `size`, the longest side of the hair's bounds. They do not depend
/// on the voxels, so that the bake and the reference compute the same quantity.
struct ShadowScale {
    double size = 1;
    /// Points up to this deep below the surface (a voxel of the default grid) still count as lying on it.
    double reach() const { return size / 256; }
    /// Rays of points on the surface start at this height above it.
    double lift() const { return size / 5000; }
};

/// The longest side of the bounding box of `points`; where it is 0, that of the mesh; where both are 0, it is 1.
ShadowScale shadow_scale(std::span<const Vec3f> points, const TriangleMesh& occluder);

/// A point that counts as lying on the occluder. (The roots of hair lie a little above or below the scalp.)
struct GroundedPoint {
    std::uint32_t point;  ///< index into the points that were given
    Vec3f origin;         ///< start of its rays: its nearest point of the surface, lifted along the normal
    Vec3f normal;         ///< outward; directions with normal . l <= 0 are blocked
};

/// Those of `points` whose nearest triangle is at most scale.lift() below them (on the side of its normal) or
/// scale.reach() above them, in ascending order. The rays of every other point start at the point itself; inside a
/// closed mesh all of them are blocked. A triangle runs counter-clockwise seen from outside; a closed mesh may be
/// inside out.
/// The same for any thread count.
/// Throws Error(cancelled).
std::vector<GroundedPoint> ground_points(std::span<const Vec3f> points, const TriangleMesh& occluder,
                                         const ShadowScale& scale, Progress& progress);

}  // namespace hairbake
