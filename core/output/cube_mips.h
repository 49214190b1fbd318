// The mip chain of a cube map.
#pragma once

#include <vector>

#include "core/environment/cube_map.h"

namespace hairbake {

/// Levels of faces of `face_size`, n/2, n/4 (rounded down) ... 1.
int mip_level_count(int face_size);

/// All levels, the first being `texels` itself. A texel of a level is the mean of the texels that it covers in the
/// level before, weighted by their solid angles. Where an odd size was halved, the weight also has the covered share of
/// their area. A constant map stays constant. With a power of two, each level keeps the map's mean over the sphere.
std::vector<CubeTexels> cube_mips(const CubeTexels& texels, int face_size);

}  // namespace hairbake
