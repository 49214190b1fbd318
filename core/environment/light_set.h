// An environment as a few ten thousand point lights.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Directional lights in the world frame, structure of arrays for the kernel sums.
struct LightSet {
    std::vector<float> x, y, z;  ///< unit directions to the lights
    std::vector<float> flux;     ///< [4 * size()]: red, green, blue, 0; radiance times steradian, >= 0
    double radius = 0;           ///< largest distance (radians) of a texel of the map from its light
    Vec3d total;                 ///< sum of the flux, summed in double

    std::size_t size() const { return x.size(); }
};

/// Gathers the texels of `map` in cells, one light for each cell (docs/math.md, "Exact light sums").
///   map         repaired radiance
///   resolution  cells along a quarter of a great circle, 1 to 4096
/// A light is at its cell's flux centroid (weighted with the sum of the channels), which keeps flux and first moment. A
/// kernel is then wrong only by its curvature times the spread inside a cell.
/// Cells of a lat-long map are the pieces of 2 * resolution latitude bands, each cut into 4 * resolution * sin(theta)
/// pieces. They are nearly square and aligned with the map's rows. So a row is cut into runs once, and no texel needs a
/// division. Cells of a cube map are resolution^2 rectangles of a face, of equal angle along its edges. Cells without
/// light are left out. No cell is smaller than a texel, so each texel of a small map becomes a light (in a lat-long map
/// except near the poles). Exact solid angles, double sums; the same bytes for any thread count.
/// Throws Error(bad_input) for a negative, infinite or NaN cell, Error(cancelled).
LightSet make_light_set(const EnvironmentMap& map, int resolution, const Progress& progress);

}  // namespace hairbake
