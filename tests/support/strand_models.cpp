#include "tests/support/strand_models.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hairbake::test_support {

std::uint32_t StrandModel::add(const std::vector<Vec3d>& points, double width, double opacity) {
    const auto first = static_cast<std::uint32_t>(positions_.size());
    positions_.insert(positions_.end(), points.begin(), points.end());
    widths_.resize(positions_.size(), width);
    opacities_.resize(positions_.size(), opacity);
    begin_.push_back(static_cast<std::uint32_t>(positions_.size()));
    return first;
}

std::uint32_t StrandModel::add_probes(const std::vector<Vec3d>& points) {
    const auto first = static_cast<std::uint32_t>(positions_.size());
    // A probe is as thin as the strands before it, so that it neither widens nor narrows the voxels; its opacity is 0,
    // so that nothing is corrected for a strand of its own.
    const double width = widths_.empty() ? 1e-6 : widths_.front();
    for (const Vec3d& p : points) add({p}, width, 0);
    return first;
}

void StrandModel::add_box(const Vec3d& low, const Vec3d& high) { add_probes({low, high}); }

StrandGeometry StrandModel::geometry(const std::function<Vec3d(const Vec3d&)>& map, double width_scale) const {
    HairModel model;
    model.strand_begin = begin_;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
        model.positions.push_back(Vec3f(map(positions_[i])));
        model.thickness.push_back(static_cast<float>(widths_[i] * width_scale));
        model.transparency.push_back(static_cast<float>(1 - opacities_[i]));
    }
    StrandSettings settings;
    settings.opacity_from_file = true;
    return make_strand_geometry(model, settings);
}

StrandGeometry StrandModel::geometry() const {
    return geometry([](const Vec3d& p) { return p; });
}

std::vector<Vec3d> straight(const Vec3d& a, const Vec3d& b, int count) {
    std::vector<Vec3d> points;
    for (int i = 0; i <= count; ++i) points.push_back(a + (b - a) * (double(i) / count));
    return points;
}

Vec3d random_direction(Random& random) {
    const double z = random.next(-1, 1), phi = random.next(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

Vec3d random_point_in_box(Random& random, const Vec3d& low, const Vec3d& high) {
    const double x = random.next(low.x, high.x), y = random.next(low.y, high.y);
    return {x, y, random.next(low.z, high.z)};
}

Vec3d random_point_in_ball(Random& random, double radius) {
    const Vec3d direction = random_direction(random);
    return direction * (radius * std::cbrt(random.next()));
}

Body ball(double radius) {
    return [radius](const Vec3d& p, const Vec3d& d) -> Interval {
        const double middle = -dot(p, d), discriminant = middle * middle - dot(p, p) + radius * radius;
        if (discriminant <= 0) return {1, 0};
        return {middle - std::sqrt(discriminant), middle + std::sqrt(discriminant)};
    };
}

Body box(const Vec3d& low, const Vec3d& high) {
    return [low, high](const Vec3d& p, const Vec3d& d) -> Interval {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        Interval inside{-infinity, infinity};
        for (int axis = 0; axis < 3; ++axis) {
            if (d[axis] == 0) {
                if (p[axis] < low[axis] || p[axis] > high[axis]) return {1, 0};
                continue;
            }
            const double a = (low[axis] - p[axis]) / d[axis], b = (high[axis] - p[axis]) / d[axis];
            inside = {std::max(inside.begin, std::min(a, b)), std::min(inside.end, std::max(a, b))};
        }
        return inside;
    };
}

void fill(StrandModel& model, const Body& body, const Vec3d& low, const Vec3d& high, const Fibres& fibres,
          Random& random) {
    // Centres lie in the box and half a length around it, so that fibres cut off at the surface are there as well.
    const Vec3d margin(fibres.length / 2), from = low - margin, to = high + margin, side = to - from;
    const double mean_sine = fibres.parallel_to_z ? 1 : std::numbers::pi / 4;
    const double length_per_volume = fibres.extinction / (fibres.opacity * fibres.width * mean_sine);
    const auto count = std::llround(length_per_volume * side.x * side.y * side.z / fibres.length);
    for (long long k = 0; k < count; ++k) {
        const Vec3d centre = random_point_in_box(random, from, to);
        const Vec3d direction = fibres.parallel_to_z ? Vec3d(0, 0, 1) : random_direction(random);
        const Interval inside = body(centre, direction);
        const double begin = std::max(inside.begin, -fibres.length / 2), end = std::min(inside.end, fibres.length / 2);
        if (begin < end)
            model.add({centre + direction * begin, centre + direction * end}, fibres.width, fibres.opacity);
    }
}

std::function<Vec3d(const Vec3d&)> rotation(const Vec3d& axis, double angle) {
    const Vec3d k = normalized(axis);
    return [k, c = std::cos(angle), s = std::sin(angle)](const Vec3d& p) {
        return p * c + cross(k, p) * s + k * (dot(k, p) * (1 - c));
    };
}

std::vector<float> bake(const StrandGeometry& strands, const TransmittanceSettings& settings) {
    Progress progress;
    return bake_transmittance_volume({strands}, settings, progress).average;
}

TransmittanceSettings with_voxels(int voxels, int directions) {
    TransmittanceSettings settings;
    settings.voxels = voxels;
    settings.directions = directions;
    return settings;
}

TransmittanceSettings with_voxel_size(double size, int directions) {
    TransmittanceSettings settings = with_voxels(256, directions);
    settings.voxel_size = size;
    return settings;
}

}  // namespace hairbake::test_support
