// A cube whose faces show their orientation: for the pictures of the layouts and the tests of every reader and writer
// of cubes and lat-longs.
#pragma once

#include <vector>

#include "core/environment/cube_map.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Radiance from a direction (any length but 0). With d scaled so that its largest component is 1, each channel tells
/// one axis: 1 where the component is above 3/4, 1/16 where it is below -3/4, 1/2 between. Every face, edge and corner
/// of the cube thus has a colour of its own, which follows from the world direction alone: the faces' middles are
///   +X (1, .5, .5)  -X (.0625, .5, .5)  +Y (.5, 1, .5)  -Y (.5, .0625, .5)  +Z (.5, .5, 1)  -Z (.5, .5, .0625),
/// the edge between +X and +Y (1, 1, .5), the corner of +X, -Y and +Z (1, .0625, 1).
/// Over the middle stand the face's name in white (4, 4, 4) and above it a black arrow, (0, 0, 0), to the top; both are
/// upright in the face as it is stored (row 0 on top, cube_map.h). The lower half of the middle, b > 0.35, and the
/// face's centre are free of them. All values are exact in half floats and RGBE.
Vec3f labelled_radiance(const Vec3d& direction);

/// The colour of labelled_radiance without name and arrow.
Vec3f labelled_colour(const Vec3d& direction);

/// Below each face's name, beside the middle of every edge and every corner of each face: 6 (1 + 4 + 4) directions
/// whose radiance is labelled_colour. 0.9 of the way to an edge is far from the lines at 0.75 and 1 where colours
/// change.
std::vector<Vec3d> labelled_directions();

/// The texel of `map` that `direction` meets.
Vec3f texel_towards(const EnvironmentMap& map, const Vec3d& direction);

/// labelled_radiance at the centres of the texels. Legible from faces of 22 on, and crisp at multiples of it.
CubeTexels labelled_cube(int face_size);

}  // namespace hairbake
