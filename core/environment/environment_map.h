// An environment: radiance that arrives from every direction, as a lat-long map or a cube map.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/environment/color_primaries.h"
#include "core/environment/environment_settings.h"

namespace hairbake {

/// A 3 x 3 matrix by rows.
using Matrix3 = std::array<Vec3d, 3>;

/// Invalid pixels by kind, and how they were repaired. Energies are in the file's own unit (radiance times steradian),
/// before exposure and tint.
struct RadianceRepairs {
    std::uint64_t negative_pixels = 0, nan_pixels = 0, infinite_pixels = 0;
    double energy_removed = 0;  ///< sum over clamped negative values of |value| * solid angle, all channels
    double solid_angle = 0;     ///< of the infinite and NaN pixels, steradians
    double energy_total = 0;    ///< sum of value * solid angle after repair, all channels
};

enum class EnvironmentShape {
    latlong,  ///< width = 2 height; EnvironmentMap::latlong is the convention of its directions
    cube      ///< six faces of width x width below one another as in cube_map.h; height = 6 width
};

/// Linear, scene-referred RGB radiance. pixels[row * width + column]; for a cube that index is cube_texel_index. A
/// texel's direction is the one that the lat-long convention or the cube gives it, turned by the rotation. Convention
/// and rotation are not applied to the pixels, and a cube stays a cube, so nothing is resampled. Exposure and tint are
/// applied.
struct EnvironmentMap {
    EnvironmentShape shape = EnvironmentShape::latlong;
    int width = 0, height = 0;
    std::vector<Vec3f> pixels;
    LatLong latlong = LatLong::gltf;                                   ///< never automatic; not used for a cube
    Matrix3 rotation{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};  ///< rows of the active matrix

    std::string source_format;                              ///< "hdr", "openexr", ... as OpenImageIO names it
    EnvironmentLayout layout = EnvironmentLayout::latlong;  ///< that was read; never automatic
    NamedPrimaries primaries;                               ///< of the pixels, after a conversion
    bool low_dynamic_range = false;                         ///< 8 or 16 bit integer input, sRGB decoded
    RadianceRepairs repairs;
    std::vector<std::string> warnings;  ///< for the user
};

/// transform() is m * v. transform_back() is transpose(m) * v, the inverse for the orthogonal matrices here.
inline Vec3d transform(const Matrix3& m, const Vec3d& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }
inline Vec3d transform_back(const Matrix3& m, const Vec3d& v) { return m[0] * v.x + m[1] * v.y + m[2] * v.z; }

/// Active right-handed rotation about world X first, then Y, then Z, in degrees.
Matrix3 rotation_matrix(const std::array<double, 3>& rotation_deg);

/// The orthogonal matrix from the map's own frame to the world.
/// A lat-long map's own frame is its polar frame (latlong.h): the matrix is the convention, then the rotation. Its
/// determinant is +1 for `filament` and -1 for the others, which differ by a mirror image. A cube's own frame is that
/// of cube_map.h: the matrix is the rotation.
Matrix3 map_to_world(const EnvironmentMap& map);

/// A point of the map in pixels: x in [0, width], y in [0, height]; texel (column, row) has its centre at (column +
/// 0.5, row + 0.5). In a cube y runs through the faces: y = k width belongs to face k, and y = 6 width to the last
/// face.
struct MapPoint {
    double x = 0, y = 0;
};

/// World direction (unit) of a point of the map, and the point of a world direction (any length but 0).
/// The two are inverse to each other. At the poles of a lat-long map every x is the same direction; x = width and x = 0
/// are the same meridian. Thread-safe.
Vec3d direction_of(const EnvironmentMap& map, MapPoint point);
MapPoint point_of(const EnvironmentMap& map, const Vec3d& direction);

/// Exact solid angles of a map's texels: that of (column, row) is row[row] * texel[row % period * width + column]. They
/// sum to 4 pi. A lat-long map's texels differ by row alone; the six faces of a cube have the same solid angles.
struct TexelSolidAngles {
    std::vector<double> row;    ///< [height]
    std::vector<double> texel;  ///< [period * width]
    int period = 1, width = 0;

    const double* texels_of_row(int y) const { return texel.data() + std::size_t(y % period) * width; }
    double at(int x, int y) const { return row[y] * texels_of_row(y)[x]; }
};
TexelSolidAngles texel_solid_angles(const EnvironmentMap& map);

/// The place of a texel for messages: "pixel (x, y)", for a cube "pixel (x, y) of face -Z", counted from the face's
/// upper left corner.
std::string place_of_texel(const EnvironmentMap& map, std::size_t index);

}  // namespace hairbake
