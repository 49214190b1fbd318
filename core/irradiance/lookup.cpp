#include "core/irradiance/lookup.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hairbake {

Vec3d look_up_diffuse(const IrradianceMaps& maps, const Vec3d& tangent) {
    return sample_cube(maps.diffuse, maps.face_size, tangent);
}

Vec3d look_up_specular(const IrradianceMaps& maps, const Vec3d& tangent, const Vec3d& to_eye) {
    const int last = static_cast<int>(maps.specular.size()) - 1;
    const double theta = std::acos(std::clamp(dot(tangent, to_eye), -1.0, 1.0));
    const double x = last * theta / std::numbers::pi;
    const int m = std::min(static_cast<int>(x), last - 1);
    const double f = x - m;
    return sample_cube(maps.specular[m], maps.face_size, tangent) * (1 - f) +
           sample_cube(maps.specular[m + 1], maps.face_size, tangent) * f;
}

}  // namespace hairbake
