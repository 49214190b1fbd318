#include "core/environment/light_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/environment/cube_map.h"
#include "core/environment/latlong.h"

namespace hairbake {

using std::numbers::pi;

namespace {

// ---- lat-long ------------------------------------------------------------------------------------------------------

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
void add_run(const Grid& grid, int y, int begin, int end, LightCell& cell) {
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

std::vector<LightCell> gather_band(const Grid& grid, int band) {
    std::vector<LightCell> cells(grid.cell_count(band));
    const int count = static_cast<int>(cells.size());
    for (int y = grid.first_row(band); y < grid.first_row(band + 1); ++y)
        for (int k = 0; k < count; ++k)
            add_run(grid, y, grid.first_column(k, count), grid.first_column(k + 1, count), cells[k]);
    return cells;
}

// Upper bound of the distance between two points of a cell: the length of a path along which theta and phi both change
// evenly.
double cell_diameter(const Grid& grid, int band, int cells) {
    const int top = grid.first_row(band), bottom = grid.first_row(band + 1);
    const double low = pi * top / grid.map.height, high = pi * bottom / grid.map.height;
    const double widest = low <= pi / 2 && high >= pi / 2 ? 1 : std::max(std::sin(low), std::sin(high));
    const int columns = (grid.map.width + cells - 1) / cells;
    return std::hypot(high - low, widest * 2 * pi * columns / grid.map.width);
}

// ---- cube ----------------------------------------------------------------------------------------------------------

// First texel of each cell along an edge of a face, and the end. Cells have equal angles, since a = tan(angle) makes
// texels near a face's middle larger than those at its edge.
std::vector<int> cell_borders(int size, int resolution) {
    const int cells = std::min(size, resolution);
    std::vector<int> borders;
    for (int k = 0; k <= cells; ++k) {
        const double a = std::tan(pi / 2 * k / cells - pi / 4);
        borders.push_back(cells == size ? k : static_cast<int>(std::lround((a + 1) / 2 * size)));
    }
    return borders;
}

struct CubeGrid {
    const EnvironmentMap& map;
    TexelSolidAngles solid_angles;
    std::vector<int> borders;

    double coordinate(double index) const { return 2 * index / map.width - 1; }
    int cells() const { return static_cast<int>(borders.size()) - 1; }
};

// Adds columns [begin, end) of one row. Directions are linear in a and b before normalising (cube_vector), so two sums
// give the moment.
void add_run(const CubeGrid& grid, int face, int row, int begin, int end, LightCell& cell) {
    const int y = face * grid.map.width + row;
    const Vec3f* pixels = grid.map.pixels.data() + std::size_t(y) * grid.map.width;
    const double* solid_angles = grid.solid_angles.texels_of_row(y);
    const double b = grid.coordinate(row + 0.5);
    double along = 0, along_a = 0;
    for (int x = begin; x < end; ++x) {
        const double a = grid.coordinate(x + 0.5);
        const Vec3d flux = Vec3d(pixels[x]) * solid_angles[x];
        const double all = (flux.x + flux.y + flux.z) / std::sqrt(1 + a * a + b * b);
        cell.flux += flux;
        along += all;
        along_a += all * a;
    }
    const Vec3d middle = cube_vector({face, 0, b}), to_right = cube_vector({face, 1, b}) - middle;
    cell.moment += middle * along + to_right * along_a;
}

std::vector<LightCell> gather_band(const CubeGrid& grid, int face, int band) {
    std::vector<LightCell> cells(grid.cells());
    for (int row = grid.borders[band]; row < grid.borders[band + 1]; ++row)
        for (int k = 0; k < grid.cells(); ++k) add_run(grid, face, row, grid.borders[k], grid.borders[k + 1], cells[k]);
    return cells;
}

// On the face a cell is a rectangle. Seen from the cube's centre, a step on it is at most the step divided by sqrt(1 +
// r^2), with r the distance from the face's middle.
double cell_diameter(const CubeGrid& grid, int band, int k) {
    const auto nearest = [](double low, double high) { return low > 0 ? low : high < 0 ? high : 0; };
    const double left = grid.coordinate(grid.borders[k]), right = grid.coordinate(grid.borders[k + 1]);
    const double top = grid.coordinate(grid.borders[band]), bottom = grid.coordinate(grid.borders[band + 1]);
    return std::hypot(right - left, bottom - top) /
           std::sqrt(1 + std::pow(nearest(left, right), 2) + std::pow(nearest(top, bottom), 2));
}

}  // namespace

LightCells gather_latlong_cells(const EnvironmentMap& map, int resolution, const Progress& progress) {
    const Grid grid{map, latlong_rows(map.width, map.height), latlong_columns(map.width),
                    std::min(map.height, 2 * resolution), resolution};
    LightCells cells;
    cells.bands.resize(grid.bands);
    parallel_for(grid.bands, 1, [&](std::size_t band, std::size_t) {
        progress.check();
        cells.bands[band] = gather_band(grid, static_cast<int>(band));
    });
    for (int band = 0; band < grid.bands; ++band)
        cells.diameter =
            std::max(cells.diameter, cell_diameter(grid, band, static_cast<int>(cells.bands[band].size())));
    return cells;
}

LightCells gather_cube_cells(const EnvironmentMap& map, int resolution, const Progress& progress) {
    const CubeGrid grid{map, texel_solid_angles(map), cell_borders(map.width, resolution)};
    LightCells cells;
    cells.bands.resize(std::size_t(cube_faces) * grid.cells());
    parallel_for(cells.bands.size(), 1, [&](std::size_t i, std::size_t) {
        progress.check();
        cells.bands[i] = gather_band(grid, int(i) / grid.cells(), int(i) % grid.cells());
    });
    for (int band = 0; band < grid.cells(); ++band)
        for (int k = 0; k < grid.cells(); ++k) cells.diameter = std::max(cells.diameter, cell_diameter(grid, band, k));
    return cells;
}

}  // namespace hairbake
