#include "core/render/vertex_transmittance.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hairbake {

double EffectiveTransmittance::at(const StrandPlace& place, std::size_t component) const {
    const std::size_t stride = diffuse + cosines, first = place.vertex * stride + component;
    return (1 - place.u) * double(values[first]) + place.u * double(values[first + stride]);
}

Vec3d EffectiveTransmittance::diffuse_at(const StrandPlace& place) const {
    if (diffuse == 1) return Vec3d(at(place, 0));
    return {at(place, 0), at(place, 1), at(place, 2)};
}

double EffectiveTransmittance::specular_at(const StrandPlace& place, double cosine) const {
    const double x = std::clamp(cosine, -1.0, 1.0);
    double before = 1, now = x, sum = at(place, diffuse);  // cos((j - 1) theta'), cos(j theta')
    for (std::size_t j = 1; j < cosines; ++j) {
        sum += at(place, diffuse + j) * now;
        before = std::exchange(now, 2 * x * now - before);
    }
    return std::clamp(sum, 0.0, 1.0);
}

BentCone::BentCone(double average, const Vec3d& moment) {
    const double first = length(moment);
    if (!(average > 0)) return;
    const double b = std::min(1.0, first / average), share = 1 - b;
    if (first > 0) axis_ = moment / first;
    cosine_ = 2 * b - 1;
    // The cosine is uniform over the sphere: a border that is symmetric in it and stays within [-1, 1] keeps the mean.
    border_ = std::min(0.25, 1 - std::abs(cosine_));
    inside_ = share > average ? average / share : 1;
}

Vec3d BentCone::moment(double average, const Vec3d& axis, double half_angle) {
    return axis * (average * 0.5 * (1 + std::cos(half_angle)));
}

double BentCone::at(const Vec3d& l) const {
    const double beyond = dot(axis_, l) - cosine_;
    if (beyond >= border_) return inside_;
    return beyond <= -border_ ? 0 : inside_ * 0.5 * (1 + beyond / border_);
}

}  // namespace hairbake
