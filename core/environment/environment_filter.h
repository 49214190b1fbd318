// Filtered look-up of an environment, for pictures that show it.
#pragma once

#include "core/base/vec.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Radiance from a world direction (any length but 0), bilinear between the centres of texels. Across the edges of a
/// cube's faces, the meridian where a lat-long map begins, and its poles, the texels beyond are used: the result is
/// continuous. Thread-safe.
Vec3d filtered_radiance(const EnvironmentMap& map, const Vec3d& direction);

}  // namespace hairbake
