// How the six faces of a cube lie in one picture. In every layout each face is stored as cube_map.h says (nothing is
// mirrored), and outside the faces a cross is ignored:
//
//   horizontal_cross, 4:3      vertical_cross, 3:4      horizontal_strip, 6:1         vertical_strip, 1:6
//        [+Y]                       [+Y]                [+X][-X][+Y][-Y][+Z][-Z]      [+X]
//   [-X] [+Z] [+X] [-Z]        [-X] [+Z] [+X]                                         [-X]
//        [-Y]                       [-Y]                                              [+Y]
//                                   [-Z] upside down                                  [-Y]
//                                                                                     [+Z]
//                                                                                     [-Z]
//
// The crosses are the cube's surface unfolded: neighbours in the picture are neighbours on the cube. For that, the -Z
// of a vertical cross hangs on -Y and is turned by 180 degrees. Everything here is thread-safe.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/environment/cube_map.h"

namespace hairbake {

/// Place of a face in units of faces, and whether it is stored turned by 180 degrees.
struct FacePlace {
    int column = 0, row = 0;
    bool turned = false;
};

struct CubeLayout {
    std::string_view name;
    int columns = 0, rows = 0;
    std::array<FacePlace, cube_faces> faces;
};

/// A pixel of a picture.
struct PicturePixel {
    int x = 0, y = 0;
};

/// The four layouts above.
std::span<const CubeLayout> cube_layouts();

/// The layout of that name, nullptr if it is none of the four.
const CubeLayout* find_cube_layout(std::string_view name);

/// "latlong" or the name of the cube layout that a picture of this shape has, empty if none. No two have one shape.
std::string_view layout_of_shape(int width, int height);

/// "2:1 (latlong), 4:3 (horizontal_cross), ..." for error messages.
std::string known_shapes();

/// Where the picture keeps a texel of the cube, for faces of `size` texels.
PicturePixel pixel_of_texel(const CubeLayout& layout, int size, int face, int row, int column);

/// The cube in a picture of layout.columns * size by layout.rows * size pixels.
CubeTexels take_cube(const CubeLayout& layout, int size, std::span<const Vec3f> pixels);

}  // namespace hairbake
