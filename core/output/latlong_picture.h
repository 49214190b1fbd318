// Cube maps as lat-long panoramas.
#pragma once

#include <vector>

#include "core/environment/cube_map.h"

namespace hairbake {

/// RGB rows from the top, pixels[row * width + column].
struct Picture {
    int width = 0, height = 0;
    std::vector<Vec3f> pixels;
};

/// The cube (faces of `face_size`) as a lat-long picture of width x width/2 in the gltf convention: row 0 is +Y, the
/// centre column looks along +X, right of it +Z. Bilinear look-up at the pixels' centres.
Picture to_latlong(const CubeTexels& cube, int face_size, int width);

}  // namespace hairbake
