// The labelled cube (labelled_cube.h) as pictures in every layout that an environment may have.
#pragma once

#include <string_view>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

struct LabelledPicture {
    int width = 0, height = 0;
    std::vector<Vec3f> pixels;  ///< [height * width], row 0 on top
};

/// The values around the faces of a cross.
constexpr float outside_the_cross = 0.02f;

/// horizontal_cross, vertical_cross, horizontal_strip or vertical_strip with faces of `face_size`; or gltf, filament or
/// openexr: a lat-long map, 4 * face_size wide. Made from the world directions of each square's middle, right and down
/// as written in the source for each layout, not from the tables of core/environment: the crosses are the cube
/// unfolded around +Z. `outside` is the value around a cross.
LabelledPicture labelled_picture(std::string_view layout, int face_size, float outside = outside_the_cross);

/// One face, +X -X +Y -Y +Z -Z.
LabelledPicture labelled_face(int face, int face_size);

}  // namespace hairbake
