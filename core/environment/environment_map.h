// An environment: radiance arriving from every direction, as a lat-long map or a cube map in hairbake's frame.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec.h"
#include "core/environment/environment_settings.h"

namespace hairbake {

/// A 3 x 3 matrix by rows.
using Matrix3 = std::array<Vec3d, 3>;

/// What was found wrong in the pixels and what the policy did about it; goes to the manifest. Energies are in the
/// file's own unit (radiance times steradian), before exposure and tint.
struct RadianceRepairs {
    std::uint64_t negative_pixels = 0, nan_pixels = 0, infinite_pixels = 0;
    double energy_removed = 0;  ///< sum over clamped negative values of |value| * solid angle, all channels
    double energy_total = 0;    ///< sum of value * solid angle after repair, all channels
};

enum class EnvironmentShape {
    latlong,  ///< height x 2 height; the convention `latlong` says where its directions are
    cube      ///< six faces of width x width on top of each other as in cube_map.h; height = 6 width
};

/// Linear, scene-referred RGB radiance. pixels[row * width + column], which for a cube is cube_texel_index; the texel's
/// direction is that of the lat-long convention or of the cube, followed by the rotation matrix; these are kept
/// unapplied, and a cube stays a cube, so that nothing is resampled. exposure and tint are already applied to the
/// pixels.
struct EnvironmentMap {
    EnvironmentShape shape = EnvironmentShape::latlong;
    int width = 0, height = 0;
    std::vector<Vec3f> pixels;
    LatLong latlong = LatLong::gltf;                                   ///< says nothing about a cube
    Matrix3 rotation{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};  ///< rows of the active matrix

    std::string source_format;              ///< "hdr", "openexr", ... as OpenImageIO names it
    std::string layout = "latlong";         ///< what `auto` took: any of EnvironmentSettings::layout but auto
    std::string primaries = "unspecified";  ///< colour space of the input, kept and named, never converted
    bool low_dynamic_range = false;         ///< 8 or 16 bit integer input, sRGB decoded
    RadianceRepairs repairs;
    std::vector<std::string> warnings;  ///< for the person who gave the file
};

/// m * v, and transpose(m) * v: for the orthogonal matrices here the inverse.
inline Vec3d transform(const Matrix3& m, const Vec3d& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }
inline Vec3d transform_back(const Matrix3& m, const Vec3d& v) { return m[0] * v.x + m[1] * v.y + m[2] * v.z; }

/// "gltf", "filament", "openexr".
std::string_view name_of(LatLong convention);

/// Active right-handed rotation about world X first, then Y, then Z, in degrees.
Matrix3 rotation_matrix(const std::array<double, 3>& rotation_deg);

/// The orthogonal matrix from the map's own frame to the world. Of a lat-long map that is its polar frame (latlong.h):
/// the convention, then the rotation; its determinant is +1 for `filament` and -1 for the others: they differ by a
/// mirror image. Of a cube it is the frame of cube_map.h: the rotation alone.
Matrix3 map_to_world(const EnvironmentMap& map);

/// A point of the map in pixels: x in [0, width], y in [0, height]; texel (column, row) has its centre at + 0.5. In a
/// cube y runs through the faces; y = k width belongs to face k (the last face's end to the last face).
struct MapPoint {
    double x = 0, y = 0;
};

/// World direction (unit) of a point of the map, and the point of a world direction (any length but 0).
/// At the poles any x is right; x = width and x = 0 are the same meridian. Inverse of each other. Thread-safe.
Vec3d direction_of(const EnvironmentMap& map, MapPoint point);
MapPoint point_of(const EnvironmentMap& map, const Vec3d& direction);

/// Exact solid angles of a map's texels: of (column, row) it is row[row] times texel[row % period * width + column].
/// All texels sum to 4 pi. (A lat-long map's texels differ by row alone, the faces of a cube are alike.)
struct TexelSolidAngles {
    std::vector<double> row;    ///< [height]
    std::vector<double> texel;  ///< [period * width]
    int period = 1, width = 0;

    const double* texels_of_row(int y) const { return texel.data() + std::size_t(y % period) * width; }
    double at(int x, int y) const { return row[y] * texels_of_row(y)[x]; }
};
TexelSolidAngles texel_solid_angles(const EnvironmentMap& map);

/// Where a texel is, for people: "pixel (x, y)", for a cube "pixel (x, y) of face -Z" (from the face's upper left).
std::string place_of_texel(const EnvironmentMap& map, std::size_t index);

}  // namespace hairbake
