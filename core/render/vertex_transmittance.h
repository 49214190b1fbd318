// Transmittance of a bake at a point between two vertices.
#pragma once

#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/render/first_hit.h"

namespace hairbake {

/// A, linear between the vertices; 1 everywhere without values.
struct VertexTransmittance {
    std::span<const float> average;  ///< [V] or empty

    double at(const StrandPlace& place) const {
        if (average.empty()) return 1;
        return (1 - place.u) * double(average[place.vertex]) + place.u * double(average[place.vertex + 1]);
    }
};

/// T(x, l) from what a bake keeps of the directions: exactly one of the two is given.
struct DirectionalTransmittance {
    std::span<const float> average;    ///< [V], A
    std::span<const float> sh;         ///< [V * bands^2], order l * l + l + m (Transmittance::sh)
    int sh_bands = 0;                  ///< 1 to 4
    std::span<const float> bent_cone;  ///< [V * 4], axis and half-angle (Transmittance::bent_cone)
};

/// T over directions that a bent cone stands for: A / share inside the cone and nothing outside, with a border that is
/// soft in the cosine, so that its mean over the sphere is A. `share` = (1 - cos(half-angle)) / 2 is the cone's part of
/// the sphere. Where A > share, T inside is 1 and the mean is less than A.
class BentCone {
public:
    /// From A and the vector A |b| axis, |b| = (1 + cos(half-angle)) / 2: both are means over directions (of T and of T
    /// l), so that they may be interpolated between vertices.
    BentCone(double average, const Vec3d& moment);

    /// The first moment of a stored cone: A |b| axis.
    static Vec3d moment(double average, const Vec3d& axis, double half_angle);

    double at(const Vec3d& l) const;

private:
    Vec3d axis_;
    double inside_ = 0, cosine_ = -1, border_ = 0;
};

}  // namespace hairbake
