#include "core/render/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/error.h"
#include "core/base/short_number.h"

namespace hairbake {
namespace {

using std::numbers::pi;

[[noreturn]] void refuse(const std::string& field, const std::string& found, const std::string& allowed) {
    throw Error(ErrorKind::usage, "camera: " + field + " is " + found + "; allowed is " + allowed, field);
}

double tangent_of_half(double fov_deg) {
    if (!(fov_deg >= 1 && fov_deg <= 150)) refuse("fov_deg", short_number(fov_deg), "1 to 150");
    return std::tan(fov_deg * pi / 360);
}

/// The distance from the middle of a box at which the eye sees all its corners. A corner (x, y, z) in the camera's axes
/// is in the picture when |x| <= (d - z) tangent aspect and |y| <= (d - z) tangent.
double framing_distance(const Camera& camera, const Vec3d& low, const Vec3d& high, const Vec3d& target, double aspect) {
    constexpr double margin = 1.04;
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3d p{corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z};
        const Vec3d from_target = p - target;
        const double sideways =
            std::max(std::abs(dot(from_target, camera.right)) / aspect, std::abs(dot(from_target, camera.up)));
        distance = std::max(distance, dot(from_target, camera.backward) + margin * sideways / camera.tangent);
    }
    return distance > 0 ? distance : 1;  // a model of one point is visible from any distance
}

}  // namespace

Camera orbit_camera(const OrbitSettings& settings, const Vec3f& bounds_min, const Vec3f& bounds_max, double aspect) {
    if (!std::isfinite(settings.azimuth_deg)) refuse("azimuth_deg", "not finite", "a number of degrees");
    if (!(std::abs(settings.elevation_deg) <= 90))
        refuse("elevation_deg", short_number(settings.elevation_deg), "-90 to 90");
    if (settings.distance && !(*settings.distance > 0 && std::isfinite(*settings.distance)))
        refuse("distance", short_number(*settings.distance), "a positive length");
    if (settings.target && !is_finite(*settings.target)) refuse("target", "not finite", "a point");

    Camera camera;
    camera.tangent = tangent_of_half(settings.fov_deg);
    const double azimuth = settings.azimuth_deg * pi / 180, elevation = settings.elevation_deg * pi / 180;
    const Vec3d level{std::sin(azimuth), 0, std::cos(azimuth)};
    camera.right = {std::cos(azimuth), 0, -std::sin(azimuth)};
    camera.backward = level * std::cos(elevation) + Vec3d{0, std::sin(elevation), 0};
    camera.up = cross(camera.backward, camera.right);
    const Vec3d low(bounds_min), high(bounds_max), target = settings.target.value_or((low + high) * 0.5);
    camera.eye =
        target + camera.backward * settings.distance.value_or(framing_distance(camera, low, high, target, aspect));
    return camera;
}

Camera look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov_deg) {
    Camera camera;
    camera.tangent = tangent_of_half(fov_deg);
    if (!is_finite(eye)) refuse("eye", "not finite", "a point");
    const Vec3d back = eye - target;
    if (!is_finite(back) || !(length(back) > 0)) refuse("target", "at the eye or not finite", "another point");
    camera.eye = eye;
    camera.backward = normalized(back);
    const Vec3d side = cross(up, camera.backward);
    if (!is_finite(side) || !(length(side) > 1e-9 * length(up)))
        refuse("up", "zero or along the view", "a direction across the view");
    camera.right = normalized(side);
    camera.up = cross(camera.backward, camera.right);
    return camera;
}

}  // namespace hairbake
