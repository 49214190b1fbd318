// Projects an environment on spherical harmonics.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// c_lm = sum over every texel of radiance * Y_lm(texel centre) * exact solid angle, in the map's **own frame**
/// (map_to_world); [bands * bands]. Lat-long maps: rows first (cosine and sine sums, folded by the symmetries of the
/// circle), then Legendre columns; cubes: cube_sh_projection.h. Double sums throughout, the same bytes for any thread
/// count. `bands` in [1, 256], the width of a lat-long map even. rotate_sh(c, bands, map_to_world(map)) gives the
/// coefficients in the world. Throws Error(cancelled).
std::vector<Vec3d> project_sh(const EnvironmentMap& map, int bands, const Progress& progress);

}  // namespace hairbake
