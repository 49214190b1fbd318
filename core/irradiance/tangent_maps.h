// The texels of irradiance maps over the strand tangent.
#pragma once

#include <cstddef>
#include <numbers>
#include <vector>

#include "core/environment/cube_map.h"

namespace hairbake {

/// One diffuse cube D(t) and the specular cubes S_m(t), m = 0 .. M, for the view angles theta'_m = m pi / M. Texels are
/// radiance times steradian; Kd and Ks are not applied.
struct TangentMaps {
    int face_size = 0;
    CubeTexels diffuse;
    std::vector<CubeTexels> specular;

    TangentMaps(int size, std::size_t specular_maps)
        : face_size(size), diffuse(texel_count()), specular(specular_maps, CubeTexels(texel_count())) {}

    std::size_t texel_count() const { return std::size_t(cube_faces) * face_size * face_size; }
};

/// theta'_m of map m of `maps`: m pi / (maps - 1), radians.
inline double view_angle(std::size_t m, std::size_t maps) { return std::numbers::pi * double(m) / double(maps - 1); }

}  // namespace hairbake
