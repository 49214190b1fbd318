// Cube maps: faces, texels, exact solid angles and look-up.
//
// The faces are in the order +X -X +Y -Y +Z -Z, with the orientation of OpenGL, Direct3D and KTX. The drawing shows
// them unfolded around +Z, as stored: +a of each face is to the right, +b is down. The letters name the world axes
// along which a and b grow. Cube maps of the graphics interfaces are left-handed: in this right-handed frame the
// drawing is the view from outside.
//
//                 +----------+
//                 |    +Y    |
//                 | a:+x b:+z|
//      +----------+----------+----------+----------+
//      |    -X    |    +Z    |    +X    |    -Z    |
//      | a:+z b:-y| a:+x b:-y| a:-z b:-y| a:-x b:-y|
//      +----------+----------+----------+----------+
//                 |    -Y    |
//                 | a:+x b:-z|
//                 +----------+
//
// Direction of (a, b), both in [-1, 1], before normalising:
//   +X (1,-b,-a)  -X (-1,-b,a)  +Y (a,1,b)  -Y (a,-1,-b)  +Z (a,-b,1)  -Z (-a,-b,-1)
// Texel (column i, row j) of a face of n has a = 2 (i + 0.5) / n - 1, b = 2 (j + 0.5) / n - 1.
// Everything here is thread-safe.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

constexpr int cube_faces = 6;

/// One value per texel: texels[(face * size + row) * size + column].
using CubeTexels = std::vector<Vec3f>;

/// A point on a face: a to the right and b down, both in [-1, 1].
struct CubePoint {
    int face = 0;
    double a = 0, b = 0;
};

/// "+X", "-X", "+Y", "-Y", "+Z", "-Z".
std::string_view cube_face_name(int face);

inline std::size_t cube_texel_index(int size, int face, int row, int column) {
    return (std::size_t(face) * size + row) * size + column;
}

/// The table above: the direction of a point before normalising, on the cube of edge 2. Linear in a and b.
Vec3d cube_vector(CubePoint point);

/// Unit direction of a point, and the point of a direction of any length but 0. On an edge the largest axes tie: the
/// first of them in the order x, y, z decides the face.
Vec3d cube_direction(CubePoint point);
CubePoint cube_point(const Vec3d& direction);

/// Unit direction of the centre of a texel.
Vec3d cube_texel_direction(int size, int face, int row, int column);

/// Index (cube_texel_index) of the texel that a direction falls into.
std::size_t cube_texel_of(int size, const Vec3d& direction);

/// Index of the texel in the opposite direction; texel centres are symmetric about the cube's centre.
std::size_t cube_antipode(int size, std::size_t texel);

/// Exact solid angle of each texel of one face, [size * size], row by row, the same for all faces:
/// F(x1,y1) - F(x0,y1) - F(x1,y0) + F(x0,y0), F = atan2(x y, sqrt(x^2 + y^2 + 1)). Six faces sum to 4 pi.
std::vector<double> cube_texel_solid_angles(int size);

/// Bilinear look-up as by a GPU's seamless cube filtering: across an edge it uses the neighbouring face's texels; at a
/// corner the missing fourth texel is the mean of the three that meet there.
Vec3d sample_cube(const CubeTexels& texels, int size, const Vec3d& direction);

}  // namespace hairbake
