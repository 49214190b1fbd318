// Projects an environment on spherical harmonics.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// c_lm = the sum over every texel of radiance * Y_lm(texel centre) * exact solid angle, in the map's **own frame**
/// (map_to_world); [bands * bands]. rotate_sh(c, bands, map_to_world(map)) gives the coefficients in the world.
///   map    the width of a lat-long map is even
///   bands  1 to 256
/// Lat-long maps: first the cosine and sine sums of each row, folded by the symmetries of the circle, then Legendre
/// columns. Cubes: cube_sh_projection.h. Double sums throughout, the same bytes for any thread count.
/// Throws Error(cancelled).
std::vector<Vec3d> project_sh(const EnvironmentMap& map, int bands, const Progress& progress);

}  // namespace hairbake
