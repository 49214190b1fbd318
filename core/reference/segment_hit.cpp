#include "core/reference/segment_hit.h"

#include <algorithm>
#include <cmath>

namespace hairbake {
namespace {

/// A round cone seen from a ray: the sphere at s in [0, 1] has its centre at a + s d and the radius r + s dr.
struct Cone {
    Vec3d a, d;  ///< relative to the ray's origin
    double r, dr;

    Vec3d centre(double s) const { return a + d * s; }
    double radius(double s) const { return r + dr * s; }
};

/// The s in [begin, end] at which |v + s w|^2 - (r + s dr)^2 is least, for a convex function; else one of the ends, of
/// which the caller looks at both.
double lowest(const Vec3d& v, const Vec3d& w, double r, double dr, double begin, double end) {
    const double square = dot(w, w) - dr * dr;
    if (!(square > 0)) return begin;
    return std::clamp((r * dr - dot(v, w)) / square, begin, end);
}

Vec3d across(const Vec3d& v, const Vec3d& l) { return v - l * dot(v, l); }

/// Whether the ray's line comes into the sphere at s. The distance is measured at s itself: a polynomial in s would
/// lose the digits of a thin cone that is far away.
bool line_meets(const Cone& cone, const Vec3d& l, double s) {
    const Vec3d to_centre = across(cone.centre(s), l);
    const double radius = cone.radius(s);
    return dot(to_centre, to_centre) <= radius * radius;
}

bool origin_is_in(const Cone& cone, double s) {
    const Vec3d centre = cone.centre(s);
    const double radius = cone.radius(s);
    return dot(centre, centre) <= radius * radius;
}

}  // namespace

bool ray_meets_segment(const StrandGeometry& strands, std::uint32_t segment, const Vec3d& origin, const Vec3d& direction) {
    const Vec3d l = direction / length(direction);
    const Vec3d a = Vec3d(strands.positions[segment]) - origin, b = Vec3d(strands.positions[segment + 1]) - origin;
    const double ra = 0.5 * double(strands.widths[segment]), rb = 0.5 * double(strands.widths[segment + 1]);
    const Cone cone{a, b - a, ra, rb - ra};
    // In front of the origin the ray is nearest at the foot on its line, behind it at the origin.
    const double ahead_a = dot(a, l), ahead_b = dot(b, l);
    double begin = 0, end = 1;  // of the spheres whose centres are in front
    if (ahead_a < 0 && ahead_b < 0) end = -1;
    if (ahead_a < 0 && ahead_b >= 0) begin = ahead_a / (ahead_a - ahead_b);
    if (ahead_a >= 0 && ahead_b < 0) end = ahead_a / (ahead_a - ahead_b);
    if (begin <= end) {
        const double s = lowest(across(a, l), across(cone.d, l), cone.r, cone.dr, begin, end);
        for (const double candidate : {s, begin, end})
            if (line_meets(cone, l, candidate)) return true;
    }
    if (begin == 0 && end == 1) return false;
    const double s = lowest(a, cone.d, cone.r, cone.dr, 0, 1);
    return origin_is_in(cone, s) || origin_is_in(cone, 0) || origin_is_in(cone, 1);
}

}  // namespace hairbake
