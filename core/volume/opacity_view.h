// The view from the light in which one opacity map is drawn.
#pragma once

#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/hair/strand_geometry.h"
#include "core/visibility/transmittance_settings.h"

namespace hairbake {

/// A point in the light's view, in texels: x and y across the map, z grows away from the light.
struct LightPoint {
    float x, y, z;
};

/// Orthographic map of `width` x `height` square texels, seen from the direction l. Every point that was given to
/// make_opacity_view lies at least one texel inside the map's edge and has z >= 0.
struct OpacityView {
    Vec3d u, v, l;                                    ///< orthonormal; x runs along u, y along v, z against l
    double texel_size = 1;                            ///< model units
    double scale = 1;                                 ///< 1 / texel_size
    double origin_u = 0, origin_v = 0, origin_z = 0;  ///< of x, y and z, in model units along u, v and -l
    int width = 0, height = 0;
    /// [layers], the end of each layer, in texels behind the first hair of a texel. Each layer is `layer_spacing` times
    /// as thick as the one before; together they are as deep as the points.
    std::vector<float> layer_end;

    LightPoint project(const Vec3f& p) const {
        const Vec3d q(p);
        return {static_cast<float>((dot(q, u) - origin_u) * scale), static_cast<float>((dot(q, v) - origin_v) * scale),
                static_cast<float>((-dot(q, l) - origin_z) * scale)};
    }
};

/// points:      not empty
/// l:           unit direction towards the light
/// settings:    the longer side of the map has settings.resolution texels, unless they would be too small
/// least_texel: smallest side of a texel, model units, > 0
OpacityView make_opacity_view(std::span<const Vec3f> points, const Vec3d& l, const OpacityMapSettings& settings,
                              double least_texel);

}  // namespace hairbake
