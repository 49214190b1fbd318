#include "core/environment/light_set.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/parallel.h"
#include "core/environment/latlong.h"

namespace hairbake {

using std::numbers::pi;

namespace {

struct Cell {
    Vec3d flux;    // per channel
    Vec3d moment;  // sum of (all channels' flux) * direction, polar frame
};

struct Grid {
    const EnvironmentMap& map;
    LatLongRows rows;
    LatLongColumns columns;
    int bands;
    int resolution;

    int first_row(int band) const { return static_cast<int>(static_cast<long long>(band) * map.height / bands); }
    int cell_count(int band) const {
        const double theta = pi * 0.5 * (first_row(band) + first_row(band + 1)) / map.height;
        const int wanted = static_cast<int>(std::lround(4 * resolution * std::sin(theta)));
        return std::min(std::max(wanted, 3), map.width);
    }
    int first_column(int cell, int cells) const {
        return static_cast<int>(static_cast<long long>(cell) * map.width / cells);
    }
};

// Adds columns [begin, end) of one row to a cell.
void add_run(const Grid& grid, int y, int begin, int end, Cell& cell) {
    const Vec3f* pixels = grid.map.pixels.data() + std::size_t(y) * grid.map.width;
    double r = 0, g = 0, b = 0, along_cos = 0, along_sin = 0;
    for (int x = begin; x < end; ++x) {
        const double red = pixels[x].x, green = pixels[x].y, blue = pixels[x].z;
        const double all = red + green + blue;
        r += red;
        g += green;
        b += blue;
        along_cos += all * grid.columns.cos_phi[x];
        along_sin += all * grid.columns.sin_phi[x];
    }
    const double w = grid.rows.solid_angle[y], sine = grid.rows.sin_theta[y];
    cell.flux += Vec3d{r, g, b} * w;
    cell.moment += Vec3d{along_cos * sine, along_sin * sine, (r + g + b) * grid.rows.cos_theta[y]} * w;
}

std::vector<Cell> gather_band(const Grid& grid, int band) {
    std::vector<Cell> cells(grid.cell_count(band));
    const int count = static_cast<int>(cells.size());
    for (int y = grid.first_row(band); y < grid.first_row(band + 1); ++y)
        for (int k = 0; k < count; ++k)
            add_run(grid, y, grid.first_column(k, count), grid.first_column(k + 1, count), cells[k]);
    return cells;
}

// Distance between the furthest two points of a cell: with theta and phi both changing evenly, no path is longer.
double cell_diameter(const Grid& grid, int band, int cells) {
    const int top = grid.first_row(band), bottom = grid.first_row(band + 1);
    const double low = pi * top / grid.map.height, high = pi * bottom / grid.map.height;
    const double widest = low <= pi / 2 && high >= pi / 2 ? 1 : std::max(std::sin(low), std::sin(high));
    const int columns = (grid.map.width + cells - 1) / cells;
    return std::hypot(high - low, widest * 2 * pi * columns / grid.map.width);
}

void add_light(LightSet& lights, const Cell& cell, const Matrix3& to_world) {
    const bool valid = is_finite(cell.flux) && cell.flux.x >= 0 && cell.flux.y >= 0 && cell.flux.z >= 0;
    if (!valid)
        throw Error(ErrorKind::bad_input,
                    "the environment has negative, infinite or NaN radiance near the direction (" +
                        std::to_string(cell.moment.x) + ", " + std::to_string(cell.moment.y) + ", " +
                        std::to_string(cell.moment.z) +
                        ") of its polar frame; repair it first (invalid_radiance: clamp)",
                    "irradiance.invalid_radiance");
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
    const Grid grid{map, latlong_rows(map.width, map.height), latlong_columns(map.width),
                    std::min(map.height, 2 * resolution), resolution};
    std::vector<std::vector<Cell>> bands(grid.bands);
    parallel_for(grid.bands, 1, [&](std::size_t band, std::size_t) {
        progress.check();
        bands[band] = gather_band(grid, static_cast<int>(band));
    });
    LightSet lights;
    const Matrix3 to_world = map_to_world(map);
    for (int band = 0; band < grid.bands; ++band) {
        for (const Cell& cell : bands[band]) add_light(lights, cell, to_world);
        lights.radius = std::max(lights.radius, cell_diameter(grid, band, static_cast<int>(bands[band].size())));
    }
    return lights;
}

}  // namespace hairbake
