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
    double radius = 0;           ///< no texel of the map is further than this (radians) from its light
    Vec3d total;                 ///< sum of the flux, summed in double

    std::size_t size() const { return x.size(); }
};

/// Gathers the texels of `map` in cells and puts one light at each cell's flux centroid (weighted with the sum of the
/// channels), which keeps flux and first moment: a kernel is then wrong by its curvature times the spread inside a cell
/// only. Cells of a lat-long map are those of 2 * `resolution` latitude bands, each cut into 4 * resolution *
/// sin(theta) pieces: nearly square, about as many as a cube of resolution^2 x 6 (0.85 times), but aligned with the
/// map's rows, so that a row is cut into runs once and no texel needs a division. (The design has a cube; this is
/// faster, its cells more even, and a band belongs to one thread.) Cells of a cube map are resolution^2 rectangles of a
/// face, of equal angle along its edges. Cells without light are left out; no cell is smaller than a texel, so a small
/// map becomes its own texels (a lat-long one except near the poles). Exact solid angles, double sums; the same bytes
/// for any thread count.
/// `resolution` in [1, 4096]. Throws Error(bad_input) for a negative, infinite or NaN cell, Error(cancelled).
LightSet make_light_set(const EnvironmentMap& map, int resolution, const Progress& progress);

}  // namespace hairbake
