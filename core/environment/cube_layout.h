// Layouts of the six faces of a cube in one picture. In every layout each face is stored as cube_map.h says; nothing is
// mirrored. Pixels of a cross outside its faces are ignored.
//
//   horizontal_cross, 4:3      vertical_cross, 3:4      horizontal_strip, 6:1         vertical_strip, 1:6
//        [+Y]                       [+Y]                [+X][-X][+Y][-Y][+Z][-Z]      [+X]
//   [-X] [+Z] [+X] [-Z]        [-X] [+Z] [+X]                                         [-X]
//        [-Y]                       [-Y]                                              [+Y]
//                                   [-Z] upside down                                  [-Y]
//                                                                                     [+Z]
//                                                                                     [-Z]
//
// The crosses are the cube's surface unfolded: neighbours in the picture are neighbours on the cube. For that reason
// the face -Z of a vertical cross adjoins -Y and is turned by 180 degrees. Everything here is thread-safe.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/environment/cube_map.h"
#include "core/environment/environment_settings.h"

namespace hairbake {

/// Place of a face in units of faces, and whether it is stored turned by 180 degrees.
struct FacePlace {
    int column = 0, row = 0;
    bool turned = false;
};

struct CubeLayout {
    EnvironmentLayout layout = EnvironmentLayout::automatic;
    int columns = 0, rows = 0;
    std::array<FacePlace, cube_faces> faces;
};

/// A pixel of a picture.
struct PicturePixel {
    int x = 0, y = 0;
};

/// Places of the faces in one of the four layouts above; null for every other layout.
const CubeLayout* find_cube_layout(EnvironmentLayout layout);

/// The layout (lat-long, or one of a cube) that pictures of this shape have; empty where no layout has the shape. No
/// two layouts have the same shape.
std::optional<EnvironmentLayout> layout_of_shape(int width, int height);

/// "2:1 (latlong), 4:3 (horizontal_cross), ..." for error messages.
std::string known_shapes();

/// The pixel of the picture that holds a texel of the cube, for faces of `size` texels.
PicturePixel pixel_of_texel(const CubeLayout& layout, int size, int face, int row, int column);

/// The cube in a picture of layout.columns * size by layout.rows * size pixels; `pixels` holds exactly that many.
CubeTexels take_cube(const CubeLayout& layout, int size, std::span<const Vec3f> pixels);

}  // namespace hairbake
