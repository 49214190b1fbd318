// Baked transmittance at a point between two vertices.
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

/// Baked directional transmittance T(x, l): exactly one of `sh` and `bent_cone` is given.
struct DirectionalTransmittance {
    std::span<const float> average;    ///< [V], A
    std::span<const float> sh;         ///< [V * bands^2], order l * l + l + m (Transmittance::sh)
    int sh_bands = 0;                  ///< 1 to 4
    std::span<const float> bent_cone;  ///< [V * 4], axis and half-angle (Transmittance::bent_cone)
};

/// Baked effective transmittance (irradiance/effective_table.h), linear between the vertices.
struct EffectiveTransmittance {
    std::span<const float> values;  ///< [V * (diffuse + cosines)]
    std::size_t diffuse = 3, cosines = 3;

    /// Ad of each channel.
    Vec3d diffuse_at(const StrandPlace& place) const;
    /// As, clamped to [0, 1]. cosine: of theta', the angle between tangent and eye.
    double specular_at(const StrandPlace& place, double cosine) const;

private:
    double at(const StrandPlace& place, std::size_t component) const;
};

/// T over directions as a bent cone: A / share inside the cone and 0 outside, so that the mean over the sphere is A.
/// `share` = (1 - cos(half-angle)) / 2 is the cone's part of the sphere. The border is a linear ramp in the cosine,
/// which keeps the mean. Where A > share, T inside is 1 and the mean is less than A.
class BentCone {
public:
    /// From A and the vector A |b| axis, |b| = (1 + cos(half-angle)) / 2. Both are means over directions (of T and of T
    /// l), so they may be interpolated between vertices.
    BentCone(double average, const Vec3d& moment);

    /// The first moment of a stored cone: A |b| axis.
    static Vec3d moment(double average, const Vec3d& axis, double half_angle);

    double at(const Vec3d& l) const;

private:
    Vec3d axis_;
    double inside_ = 0, cosine_ = -1, border_ = 0;
};

}  // namespace hairbake
