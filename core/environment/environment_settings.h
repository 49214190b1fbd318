// The request's `environment_settings` block: how an environment is read.
#pragma once

#include <array>

#include "core/base/names.h"

namespace hairbake {

/// Layouts of an environment's directions in its pictures (cube_layout.h).
enum class EnvironmentLayout {
    automatic,  ///< found by the shape of the picture
    latlong,
    faces,  ///< six pictures
    horizontal_cross,
    vertical_cross,
    horizontal_strip,
    vertical_strip
};
inline constexpr std::array environment_layout_names{
    EnumName{EnvironmentLayout::automatic, "auto"},
    EnumName{EnvironmentLayout::latlong, "latlong"},
    EnumName{EnvironmentLayout::faces, "faces"},
    EnumName{EnvironmentLayout::horizontal_cross, "horizontal_cross"},
    EnumName{EnvironmentLayout::vertical_cross, "vertical_cross"},
    EnumName{EnvironmentLayout::horizontal_strip, "horizontal_strip"},
    EnumName{EnvironmentLayout::vertical_strip, "vertical_strip"},
};
constexpr std::string_view name_of(EnvironmentLayout layout) { return name_in(environment_layout_names, layout); }

/// Directions of the columns of a lat-long map. Row 0 is +Y in all conventions.
enum class LatLong {
    gltf,      ///< centre column +X, right of it +Z (three.js, glTF)
    filament,  ///< centre column +Z, right of it +X: a mirror image in this frame, as the convention asks for
    openexr    ///< centre column +Z, right of it -X
};
inline constexpr std::array latlong_names{
    EnumName{LatLong::gltf, "gltf"},
    EnumName{LatLong::filament, "filament"},
    EnumName{LatLong::openexr, "openexr"},
};
constexpr std::string_view name_of(LatLong convention) { return name_in(latlong_names, convention); }

enum class InvalidRadiance {
    reject,  ///< a negative, infinite or NaN pixel is an error that names the pixel
    clamp    ///< negative, NaN and -infinity become 0, +infinity the largest finite value of the map; all are counted
};
inline constexpr std::array invalid_radiance_names{
    EnumName{InvalidRadiance::reject, "reject"},
    EnumName{InvalidRadiance::clamp, "clamp"},
};

/// The request's `environment_settings` block.
struct EnvironmentSettings {
    EnvironmentLayout layout = EnvironmentLayout::automatic;
    LatLong latlong = LatLong::gltf;
    std::array<double, 3> rotation_deg{};  ///< active, right-handed, about world X first, then Y, then Z
    double exposure_stops = 0;             ///< radiance times 2^exposure_stops
    std::array<double, 3> tint{1, 1, 1};   ///< radiance times tint, per channel, >= 0
    InvalidRadiance invalid_radiance = InvalidRadiance::reject;
};

}  // namespace hairbake
