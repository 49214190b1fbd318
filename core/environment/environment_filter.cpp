#include "core/environment/environment_filter.h"

#include <cmath>

#include "core/environment/cube_map.h"

namespace hairbake {
namespace {

/// The texel of a lat-long map; `x` goes round, and a row beyond a pole is the first one on the other side of it.
Vec3d texel(const EnvironmentMap& map, int x, int y) {
    const int row = y < 0 ? -1 - y : y >= map.height ? 2 * map.height - 1 - y : y;
    const int column = (x + (row == y ? 0 : map.width / 2) + map.width) % map.width;
    return Vec3d(map.pixels[static_cast<std::size_t>(row) * map.width + column]);
}

Vec3d between(const Vec3d& a, const Vec3d& b, double share) { return a * (1 - share) + b * share; }

}  // namespace

Vec3d filtered_radiance(const EnvironmentMap& map, const Vec3d& direction) {
    if (map.shape == EnvironmentShape::cube)
        return sample_cube(map.pixels, map.width, transform_back(map_to_world(map), direction));
    const MapPoint point = point_of(map, direction);
    const double left = std::floor(point.x - 0.5), top = std::floor(point.y - 0.5);
    const int x = static_cast<int>(left), y = static_cast<int>(top);
    const double right = point.x - 0.5 - left, below = point.y - 0.5 - top;
    return between(between(texel(map, x, y), texel(map, x + 1, y), right),
                   between(texel(map, x, y + 1), texel(map, x + 1, y + 1), right), below);
}

}  // namespace hairbake
