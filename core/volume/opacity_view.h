// The view from the light that one opacity map is made in.
#pragma once

#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/hair/strand_geometry.h"
#include "core/volume/transmittance.h"

namespace hairbake {

/// A point as the light sees it, in texels: x and y across the map, z deeper the farther from the light.
struct LightPoint {
    float x, y, z;
};

/// Orthographic map of `width` x `height` square texels, seen from the direction l. Every point that the view was made
/// for lies at least one texel inside the map's edge and has z >= 0.
struct OpacityView {
    Vec3d u, v, l;                                    ///< orthonormal; x runs along u, y along v, z against l
    double texel_size = 1;                            ///< model units
    double scale = 1;                                 ///< 1 / texel_size
    double origin_u = 0, origin_v = 0, origin_z = 0;  ///< of x, y and z, in model units along u, v and -l
    int width = 0, height = 0;
    /// [layers], where each layer ends, in texels behind the first hair of a texel. Each is `layer_spacing` times as
    /// thick as the one before; together they are as deep as the points.
    std::vector<float> layer_end;

    LightPoint project(const Vec3f& p) const {
        const Vec3d q(p);
        return {static_cast<float>((dot(q, u) - origin_u) * scale), static_cast<float>((dot(q, v) - origin_v) * scale),
                static_cast<float>((-dot(q, l) - origin_z) * scale)};
    }
};

/// The view of `points` (not empty) from the direction l (unit vector). The longer side of the map has `resolution`
/// texels, but a texel is never smaller than `least_texel` (> 0).
OpacityView make_opacity_view(std::span<const Vec3f> points, const Vec3d& l, const OpacityMapSettings& settings,
                              double least_texel);

}  // namespace hairbake
