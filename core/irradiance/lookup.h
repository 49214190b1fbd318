// Samples irradiance maps as a renderer does at run time.
#pragma once

#include "core/base/vec.h"
#include "core/irradiance/irradiance_maps.h"

namespace hairbake {

/// D(t): bilinear across face edges. `tangent` is a unit vector from root to tip. Thread-safe.
Vec3d look_up_diffuse(const IrradianceMaps& maps, const Vec3d& tangent);

/// S(t, v): x = M acos(clamp(t . v, -1, 1)) / pi, linear between the maps floor(x) and floor(x) + 1
/// (docs/math.md, "The irradiance maps").
/// `to_eye` is a unit vector away from the hair. Thread-safe.
Vec3d look_up_specular(const IrradianceMaps& maps, const Vec3d& tangent, const Vec3d& to_eye);

}  // namespace hairbake
