// A pinhole camera.
#pragma once

#include <optional>

#include "core/base/vec.h"

namespace hairbake {

/// Eye and orthonormal right-handed axes; `backward` points from the scene to the eye.
struct Camera {
    Vec3d eye;
    Vec3d right{1, 0, 0}, up{0, 1, 0}, backward{0, 0, 1};
    double tangent = 0.25;  ///< of half the vertical field of view

    /// Unit direction through a point of the picture: x from -1 (left) to 1, y from -1 (bottom) to 1; `aspect` is the
    /// picture's width over its height.
    Vec3d direction(double x, double y, double aspect) const {
        return normalized(right * (x * tangent * aspect) + up * (y * tangent) - backward);
    }
};

/// A camera on a sphere around its target. At azimuth 0 it is at +Z of the target (in front of a head that looks along
/// +Z), at azimuth 90 at +X; at elevation 90 it looks down from +Y. Defaults follow from the bounds of the model.
struct OrbitSettings {
    std::optional<Vec3d> target;  ///< default: middle of the bounds
    std::optional<double>
        distance;  ///< model units, > 0; default: the nearest at which the whole box is in the picture
    double azimuth_deg = 0;
    double elevation_deg = 0;  ///< -90 to 90
    double fov_deg = 30;       ///< vertical field of view, 1 to 150
};

/// Throws Error(usage) naming the field out of range.
Camera orbit_camera(const OrbitSettings& settings, const Vec3f& bounds_min, const Vec3f& bounds_max, double aspect);

/// A camera at `eye` that looks at `target`; `up` is upwards in the picture.
/// Throws Error(usage) where they give no direction (eye at the target, up along the view) or the field of view is not
/// 1 to 150 degrees.
Camera look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov_deg);

}  // namespace hairbake
