#include "core/environment/latlong.h"

#include <cmath>
#include <numbers>

namespace hairbake {

using std::numbers::pi;

LatLongRows latlong_rows(int width, int height) {
    LatLongRows rows;
    for (int y = 0; y < height; ++y) {
        const double theta = pi * (y + 0.5) / height;
        rows.sin_theta.push_back(std::sin(theta));
        rows.cos_theta.push_back(std::cos(theta));
        rows.solid_angle.push_back(2 * pi / width * 2 * std::sin(theta) * std::sin(pi / (2 * height)));
    }
    return rows;
}

LatLongColumns latlong_columns(int width) {
    LatLongColumns columns;
    for (int x = 0; x < width; ++x) {
        const double phi = 2 * pi * (x + 0.5) / width - pi;
        columns.cos_phi.push_back(std::cos(phi));
        columns.sin_phi.push_back(std::sin(phi));
    }
    return columns;
}

}  // namespace hairbake
