#include "core/volume/near_field_window.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "core/volume/neighborhood.h"

namespace hairbake {
namespace {

// Integrals of (1 - z^2 / r^2)^2 / z^2 times a probability: that a point at z from a uniformly placed vertex lies in
// the voxel offset by none, one, two or three axes. Taken 1, 6, 12 and 8 times they add up to 4 pi r 8 / 15.
constexpr double kByAxes[4] = {2.6392203, 0.1068050, 0.0056982, 0.0003255};

}  // namespace

NearFieldWindow::NearFieldWindow() {
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            for (int k = -1; k <= 1; ++k) {
                const auto o = static_cast<std::size_t>(9 * (i + 1) + 3 * (j + 1) + (k + 1));
                step[o] = Neighborhood::voxel(i, j, k);
                const int axes = std::abs(i) + std::abs(j) + std::abs(k);
                weight[o] = static_cast<float>(axes == 0 ? kByAxes[0] * std::numbers::pi / 4 : kByAxes[axes]);
                if (axes == 0) continue;
                const double norm = std::sqrt(double(axes));
                direction_x[o] = static_cast<float>(i / norm);
                direction_y[o] = static_cast<float>(j / norm);
                direction_z[o] = static_cast<float>(k / norm);
            }
}

}  // namespace hairbake
