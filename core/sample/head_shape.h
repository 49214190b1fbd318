// The head that sample grooms grow on: a smooth closed shape, star-shaped about the origin.
#pragma once

#include "core/base/vec.h"

namespace hairbake {

/// Unit centimetres, Y up, the face towards +Z. The origin lies in the middle of the skull, which reaches about 9 cm
/// up and 8 to 10 cm to the sides; jaw, nose and a stub of neck (down to about y = -18) are part of the shape. Every
/// ray from the origin leaves the shape exactly once, at this distance. `direction` is a unit vector. Thread-safe.
double head_radius(const Vec3d& direction);

/// Height of `point` above the surface along the ray from the origin, negative inside; `point` is not the origin.
double height_above_head(const Vec3d& point);

/// Outward unit normal of the surface in `direction` (a unit vector).
Vec3d head_normal(const Vec3d& direction);

/// Whether hair grows in `direction` (a unit vector): above the forehead, the ears and the nape.
bool is_scalp(const Vec3d& direction);

}  // namespace hairbake
