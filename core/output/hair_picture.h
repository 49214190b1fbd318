// A groom drawn in its own transmittance, for the preview.
#pragma once

#include <span>
#include <vector>

#include "core/hair/hair_model.h"

namespace hairbake {

/// A square grey picture, rows from the top: `value` is A of the nearest strand, or negative where there is none.
struct HairPicture {
    int size = 0;
    std::vector<float> value;
};

/// Direction of the camera, which has no perspective: from +Z (the face of a head that looks along +Z) or from +X.
enum class View { front, side };

/// The whole model fitted into size x size pixels with a small margin. `average` is [V].
HairPicture draw_hair(const HairModel& model, std::span<const float> average, View view, int size);

}  // namespace hairbake
