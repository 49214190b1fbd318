// Cells of neighbouring texels; light_set.h makes one light of each.
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Sums over the texels of a cell, with their exact solid angles.
struct LightCell {
    Vec3d flux;    ///< per channel
    Vec3d moment;  ///< sum of (all channels' flux) * direction, in the frame of map_to_world
};

struct LightCells {
    std::vector<std::vector<LightCell>> bands;
    double diameter = 0;  ///< largest distance between two points of one cell (radians)
};

/// Cells of `map`, `resolution` along a quarter of a great circle; light_set.h describes their shapes. The sums are in
/// double and the same for any thread count.
/// Throws Error(cancelled).
LightCells gather_latlong_cells(const EnvironmentMap& map, int resolution, const Progress& progress);
LightCells gather_cube_cells(const EnvironmentMap& map, int resolution, const Progress& progress);

}  // namespace hairbake
