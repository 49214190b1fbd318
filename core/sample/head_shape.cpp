#include "core/sample/head_shape.h"

#include <cmath>
#include <numbers>

#include "core/base/assert.h"

namespace hairbake {
namespace {

struct Ellipsoid {
    Vec3d centre, radii;  ///< the origin lies inside
};

constexpr Ellipsoid parts[] = {
    {{0, 0, -0.5}, {7.6, 9.2, 9.4}},    // skull
    {{0, -5, 3.2}, {5.4, 7.5, 6.0}},    // jaw
    {{0, -2.2, 4.6}, {1.6, 3.2, 6.6}},  // nose
    {{0, -8, -2.2}, {5.2, 9.6, 5.4}},   // neck
};

double square(double x) { return x * x; }

/// Distance at which the ray from the origin along `direction` leaves the ellipsoid, in lengths of `direction`.
double exit_distance(const Ellipsoid& e, const Vec3d& direction) {
    const Vec3d d(direction.x / e.radii.x, direction.y / e.radii.y, direction.z / e.radii.z);
    const Vec3d c(e.centre.x / e.radii.x, e.centre.y / e.radii.y, e.centre.z / e.radii.z);
    const double a = dot(d, d), b = dot(d, c), rest = 1 - dot(c, c);  // rest > 0: the origin is inside
    return (b + std::sqrt(b * b + a * rest)) / a;
}

}  // namespace

double head_radius(const Vec3d& direction) {
    HAIRBAKE_ASSERT(std::abs(dot(direction, direction) - 1) < 1e-6);
    // The 16-norm is a smooth maximum of the parts: it rounds the creases between them.
    double sum = 0;
    for (const Ellipsoid& part : parts) sum += square(square(square(square(exit_distance(part, direction) / 10))));
    return 10 * std::sqrt(std::sqrt(std::sqrt(std::sqrt(sum))));
}

double height_above_head(const Vec3d& point) {
    const double distance = length(point);
    HAIRBAKE_ASSERT(distance > 0);
    return distance - head_radius(point / distance);
}

Vec3d head_normal(const Vec3d& direction) {
    // The surface is the zero of height_above_head: its gradient there is the normal. Central differences over a
    // step of 1e-4 cm are good to about 1e-8.
    const Vec3d point = direction * head_radius(direction);
    Vec3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d step;
        step[axis] = 1e-4;
        gradient[axis] = height_above_head(point + step) - height_above_head(point - step);
    }
    return normalized(gradient);
}

bool is_scalp(const Vec3d& direction) {
    // The hairline's elevation: 45 degrees over the forehead (+Z), 5 over the ears, -35 at the nape.
    const double across = std::hypot(direction.x, direction.z);
    const double towards_face = across > 0 ? direction.z / across : 0;
    const double hairline_deg = 5 + 40 * towards_face;
    return std::atan2(direction.y, across) * 180 / std::numbers::pi > hairline_deg;
}

}  // namespace hairbake
