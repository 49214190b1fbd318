// Turns radiance into the 8-bit colours of a screen.
#pragma once

#include <vector>

#include "core/base/vec.h"
#include "core/output/canvas.h"

namespace hairbake {

/// Stops that bring the brightest tenth of the values to a bright but unclipped tone; 0 where nine tenths are black.
double exposure_for(std::vector<float> luminances);

/// Linear RGB times 2^stops through a filmic curve to 8-bit sRGB.
Color tone(const Vec3f& rgb, double stops);

}  // namespace hairbake
