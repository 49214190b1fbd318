// Cube maps: faces, texels, exact solid angles and look-up.
//
// Faces in the order +X -X +Y -Y +Z -Z, orientation of OpenGL, Direct3D and KTX. Unfolded around +Z, as stored (right
// is each face's +a, down its +b; the letters are the world axis that a and b grow along). The graphics interfaces'
// cube maps are left-handed: in our right-handed frame this is the view from outside.
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

/// Unit direction of a point, and the point of a direction (any length but 0; on an edge the axis named first
/// in x, y, z wins).
Vec3d cube_direction(CubePoint point);
CubePoint cube_point(const Vec3d& direction);

/// Unit direction of the centre of a texel.
Vec3d cube_texel_direction(int size, int face, int row, int column);

/// Index (cube_texel_index) of the texel that a direction falls into.
std::size_t cube_texel_of(int size, const Vec3d& direction);

/// Index of the texel in the opposite direction: the cubes here are symmetric about the centre.
std::size_t cube_antipode(int size, std::size_t texel);

/// Exact solid angle of each texel of one face, [size * size], row by row, the same for all faces:
/// F(x1,y1) - F(x0,y1) - F(x1,y0) + F(x0,y0), F = atan2(x y, sqrt(x^2 + y^2 + 1)). Six faces sum to 4 pi.
std::vector<double> cube_texel_solid_angles(int size);

/// Bilinear look-up as a GPU's seamless cube filtering does it: across an edge the neighbouring face's texels are
/// taken, at a corner the missing fourth texel is the mean of the three that meet there.
Vec3d sample_cube(const CubeTexels& texels, int size, const Vec3d& direction);

}  // namespace hairbake
