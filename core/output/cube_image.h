// Cube maps as pictures: the vertical strip and the lat-long panorama.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "core/base/vec.h"
#include "core/irradiance/irradiance_maps.h"

namespace hairbake {

/// RGB rows from the top, pixels[row * width + column].
struct Picture {
    int width = 0, height = 0;
    std::vector<Vec3f> pixels;
};

inline constexpr std::array<std::string_view, 6> face_names{"+X", "-X", "+Y", "-Y", "+Z", "-Z"};

/// Where a unit direction meets the cube: the face, and its coordinates a to the right and b down, in [-1, 1]
/// (design, Conventions).
struct CubePoint {
    int face;
    double a, b;
};
CubePoint cube_point(const Vec3d& direction);

/// Direction (not of unit length) through the point; a and b may leave [-1, 1].
Vec3d cube_direction(const CubePoint& point);

/// Bilinear between texel centres, across the edges of faces too.
Vec3f look_up(const CubeTexels& cube, int face_size, const Vec3d& direction);

/// Direction of the centre of pixel (row, column) in the gltf convention: row 0 is +Y, the centre column looks along
/// +X, right of it +Z.
Vec3d latlong_direction(int row, int column, int width, int height);

/// The cube as a gltf lat-long picture of width x width/2.
Picture to_latlong(const CubeTexels& cube, int face_size, int width);

}  // namespace hairbake
