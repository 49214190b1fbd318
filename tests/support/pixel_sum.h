// The slow truth for irradiance maps: the sum over every pixel of the environment.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/environment/environment_map.h"
#include "core/irradiance/irradiance_maps.h"

namespace hairbake::testing {

/// For each tangent: D, then S_m for m = 0 .. maps - 1, [tangents * (1 + maps)]: the sum over every texel, in double,
/// of radiance * exact solid angle * kernel at the texel's centre. It shares only the map's geometry with the code
/// under test: kernels come from dot products as in docs/math.md, "The Kajiya-Kay kernels", powers of 2 by repeated
/// squaring, others by std::pow.
std::vector<Vec3d> sum_over_pixels(const EnvironmentMap& map, std::span<const Vec3d> tangents, double exponent,
                                   int maps);

/// Root mean square over the tangents' texels, a lobe's maps and channels of (baked - truth), divided by the largest
/// value of the same lobe: of the truth at the tangents, or of the baked maps anywhere.
struct MapError {
    double diffuse = 0, specular = 0;
    double specular_relative = 0;  ///< specular RMS / the specular maps' own root mean square
};
MapError compare(const IrradianceMaps& maps, std::span<const std::size_t> texels, const std::vector<Vec3d>& truth);

/// Every `step`-th texel of a cube and their directions.
struct TexelSample {
    std::vector<std::size_t> texels;
    std::vector<Vec3d> tangents;
};
TexelSample sample_texels(int face_size, int step);

}  // namespace hairbake::testing
