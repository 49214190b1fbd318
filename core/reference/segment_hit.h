// Whether a ray meets a segment of a strand, in double precision.
#pragma once

#include <cstdint>

#include "core/hair/strand_geometry.h"

namespace hairbake {

/// Whether the ray from `origin` along `direction` meets the segment: a round cone, which is the convex hull of the two
/// spheres about its ends with its widths as diameters. A ray that starts inside the segment meets it.
///
/// origin:    in model units
/// direction: of any length but 0: a unit vector of floats is too short or too long by 1e-7, which counts far away
///
/// Embree intersects round cones in single precision. Its error in the squared distance is of the order of 1e-7 times
/// the squared length of the segment or the distance of the ray's origin, which exceeds the squared radius of a segment
/// that is some thousand times longer than wide. Embree therefore gets thicker segments (StrandScene), and this
/// function decides. Its own error in the distance is some 1e-15 of the larger of these lengths.
bool ray_meets_segment(const StrandGeometry& strands, std::uint32_t segment, const Vec3d& origin, const Vec3d& direction);

}  // namespace hairbake
