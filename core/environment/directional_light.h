// A light at infinity.
#pragma once

#include "core/base/vec.h"

namespace hairbake {

/// One of the request's `lights`; it is added to the maps with the exact kernel. It is in the world frame: rotation,
/// exposure and tint of the environment do not change it.
struct DirectionalLight {
    Vec3d direction;   ///< towards the light, any length but 0
    Vec3d irradiance;  ///< RGB, of a surface that faces the light; >= 0
};

}  // namespace hairbake
