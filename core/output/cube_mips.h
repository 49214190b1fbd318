// The mip chain of a cube map.
#pragma once

#include <vector>

#include "core/environment/cube_map.h"

namespace hairbake {

/// Levels of faces of `face_size`, n/2, n/4 (rounded down) ... 1.
int mip_level_count(int face_size);

/// All levels, the first being `texels` itself. A texel of a level is the mean of the texels of the level before that
/// it covers, weighted by their solid angles (and, where an odd size was halved, by the covered share of their area): a
/// constant map stays constant, and with a power of two each level keeps the map's mean over the sphere.
std::vector<CubeTexels> cube_mips(const CubeTexels& texels, int face_size);

}  // namespace hairbake
