#include "core/environment/light_set.h"

#include <string>

#include "core/base/assert.h"
#include "core/environment/light_cells.h"

namespace hairbake {
namespace {

void add_light(LightSet& lights, const LightCell& cell, const Matrix3& to_world) {
    const bool valid = is_finite(cell.flux) && cell.flux.x >= 0 && cell.flux.y >= 0 && cell.flux.z >= 0;
    if (!valid)
        throw Error(ErrorKind::bad_input,
                    "the environment has negative, infinite or NaN radiance near the direction (" +
                        std::to_string(cell.moment.x) + ", " + std::to_string(cell.moment.y) + ", " +
                        std::to_string(cell.moment.z) + ") of its own frame; repair it first (invalid_radiance: clamp)",
                    "environment_settings.invalid_radiance");
    const double norm = length(cell.moment);
    if (norm == 0) return;
    const Vec3d d = transform(to_world, cell.moment / norm);
    lights.x.push_back(static_cast<float>(d.x));
    lights.y.push_back(static_cast<float>(d.y));
    lights.z.push_back(static_cast<float>(d.z));
    for (const double channel : {cell.flux.x, cell.flux.y, cell.flux.z, 0.0})
        lights.flux.push_back(static_cast<float>(channel));
    lights.total += cell.flux;
}

}  // namespace

LightSet make_light_set(const EnvironmentMap& map, int resolution, const Progress& progress) {
    HAIRBAKE_ASSERT(resolution >= 1 && resolution <= 4096);
    const LightCells cells = map.shape == EnvironmentShape::cube ? gather_cube_cells(map, resolution, progress)
                                                                 : gather_latlong_cells(map, resolution, progress);
    LightSet lights;
    const Matrix3 to_world = map_to_world(map);
    for (const std::vector<LightCell>& band : cells.bands)
        for (const LightCell& cell : band) add_light(lights, cell, to_world);
    lights.radius = cells.diameter;
    return lights;
}

}  // namespace hairbake
