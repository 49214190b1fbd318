// Projects a cube map on spherical harmonics; sh_projection.h calls it.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// project_sh() for a map of shape cube: c_lm = the sum over every texel of radiance * Y_lm(texel centre) * exact solid
/// angle, in the frame of cube_map.h. `bands` is 1 to 256.
/// The eight texels that differ in the signs of x, y and z are summed together: every Y_lm is even or odd in each of
/// them, so only an eighth of the harmonics is evaluated. Double sums, the same bytes for any thread count.
/// Throws Error(cancelled).
std::vector<Vec3d> project_cube_sh(const EnvironmentMap& map, int bands, const Progress& progress);

}  // namespace hairbake
