#include "core/reference/crossings.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hairbake {
namespace {

/// The part of a ray inside a body; empty when begin > end.
struct Way {
    double begin = std::numeric_limits<double>::infinity(), end = -begin;
};

Way joined(const Way& a, const Way& b) { return {std::min(a.begin, b.begin), std::max(a.end, b.end)}; }

/// Roots of a t^2 + 2 b t + c < 0, a > 0.
Way between_roots(double a, double b, double c) {
    const double discriminant = b * b - a * c;
    if (discriminant < 0) return {};
    const double root = std::sqrt(discriminant);
    return {(-b - root) / a, (-b + root) / a};
}

/// The part of the ray t l inside a sphere.
Way through_sphere(const Vec3d& centre, const Vec3d& l, double radius) {
    return between_roots(1, -dot(centre, l), dot(centre, centre) - radius * radius);
}

/// The part of the ray t l inside the cylinder about the axis from a to a + axis.
Way through_cylinder(const Vec3d& a, const Vec3d& axis, const Vec3d& l, double radius) {
    const double axis_length = length(axis);
    const Vec3d unit = axis / axis_length;
    const Vec3d across_l = l - unit * dot(l, unit), across_a = a - unit * dot(a, unit);
    const double climb = dot(l, unit), foot = dot(a, unit), square = dot(across_l, across_l);
    if (square < 1e-14) return {};  // along the axis: the end spheres cover all of it
    Way way = between_roots(square, -dot(across_l, across_a), dot(across_a, across_a) - radius * radius);
    if (std::abs(climb) > 1e-9) {
        const double t0 = foot / climb, t1 = (foot + axis_length) / climb;
        way = {std::max(way.begin, std::min(t0, t1)), std::min(way.end, std::max(t0, t1))};
    } else if (foot > 0 || foot + axis_length < 0) {
        return {};
    }
    return way.begin <= way.end ? way : Way{};
}

/// The part of a ray inside a segment with round ends. The segment is as thick as its thicker end, plus a rounding
/// error.
Way through_segment(const StrandGeometry& strands, std::uint32_t segment, const Vec3d& origin, const Vec3d& l) {
    const Vec3d a = Vec3d(strands.positions[segment]) - origin, b = Vec3d(strands.positions[segment + 1]) - origin;
    const double radius = 0.5001 * double(std::max(strands.widths[segment], strands.widths[segment + 1]));
    const Way ends = joined(through_sphere(a, l, radius), through_sphere(b, l, radius));
    return joined(ends, through_cylinder(a, b - a, l, radius));
}

std::size_t strand_of(const StrandGeometry& strands, std::uint32_t segment) {
    const auto& begin = strands.strand_begin;
    return static_cast<std::size_t>(std::upper_bound(begin.begin(), begin.end(), segment) - begin.begin());
}

struct Passage {
    std::size_t strand;
    Way way;
    float opacity;
};

}  // namespace

float transmittance_of_crossings(const StrandGeometry& strands, const Vec3f& origin, const Vec3f& l,
                                 std::vector<std::uint32_t>& hit) {
    std::sort(hit.begin(), hit.end());
    hit.erase(std::unique(hit.begin(), hit.end()), hit.end());
    std::vector<Passage> passages;
    passages.reserve(hit.size());
    for (const std::uint32_t segment : hit)
        passages.push_back({strand_of(strands, segment), through_segment(strands, segment, Vec3d(origin), Vec3d(l)),
                            0.5f * (strands.opacities[segment] + strands.opacities[segment + 1])});
    std::sort(passages.begin(), passages.end(), [](const Passage& a, const Passage& b) {
        return a.strand != b.strand ? a.strand < b.strand : a.way.begin < b.way.begin;
    });
    float transmittance = 1;
    double left = 0;  // where the ray leaves its present strand
    for (std::size_t k = 0; k < passages.size(); ++k) {
        const Passage& passage = passages[k];
        const bool inside = k > 0 && passages[k - 1].strand == passage.strand && passage.way.begin <= left;
        if (!inside) transmittance *= 1 - passage.opacity;
        left = inside ? std::max(left, passage.way.end) : passage.way.end;
    }
    return transmittance;
}

}  // namespace hairbake
