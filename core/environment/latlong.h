// Geometry of a lat-long grid in its own polar frame, which is the same for every convention.
//
// Polar frame of a map: z through the centre of the top edge (row 0), x through the centre column, y a quarter turn to
// the right of it. A point (x, y) in pixels, x in [0, width] to the right, y in [0, height] down, looks along
//     theta = pi y / height,  phi = 2 pi x / width - pi,  (sin theta cos phi, sin theta sin phi, cos theta).
// map_to_world() of environment_map.h is the matrix from there to the world.
#pragma once

#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// Sines and cosines of the rows' centres and the exact solid angle of one texel of each row:
/// 2 pi / width * (cos theta_top - cos theta_bottom), computed as a product of sines so that no digits cancel at the
/// poles. The sum over all texels is 4 pi to rounding.
struct LatLongRows {
    std::vector<double> sin_theta, cos_theta, solid_angle;  ///< [height]
};
LatLongRows latlong_rows(int width, int height);

/// cos phi and sin phi of the columns' centres, [width].
struct LatLongColumns {
    std::vector<double> cos_phi, sin_phi;
};
LatLongColumns latlong_columns(int width);

}  // namespace hairbake
