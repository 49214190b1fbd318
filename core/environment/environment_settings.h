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
    automatic,  ///< openexr where an EXR file's envmap attribute says lat-long, else gltf
    gltf,       ///< centre column +X, right of it +Z (three.js, glTF)
    filament,   ///< centre column +Z, right of it +X: a mirror image in this frame, as the convention asks for
    openexr     ///< centre column +Z, right of it -X
};
inline constexpr std::array latlong_names{
    EnumName{LatLong::automatic, "auto"},
    EnumName{LatLong::gltf, "gltf"},
    EnumName{LatLong::filament, "filament"},
    EnumName{LatLong::openexr, "openexr"},
};
constexpr std::string_view name_of(LatLong convention) { return name_in(latlong_names, convention); }

/// What happens to pixels of negative, infinite or NaN radiance. Clamped means: negative, NaN and -infinity become 0,
/// +infinity becomes the largest finite value of the map; all are counted.
enum class InvalidRadiance {
    automatic,  ///< clamped, with an error above 1 % of the light or of the sphere
    reject,     ///< an error that names the first pixel
    clamp       ///< clamped, any amount
};
inline constexpr std::array invalid_radiance_names{
    EnumName{InvalidRadiance::automatic, "auto"},
    EnumName{InvalidRadiance::reject, "reject"},
    EnumName{InvalidRadiance::clamp, "clamp"},
};

constexpr std::string_view name_of(InvalidRadiance policy) { return name_in(invalid_radiance_names, policy); }

/// Primaries of the maps. Colours are converted with the Bradford adaptation of the white point.
enum class ToPrimaries {
    file,        ///< those of the file: nothing is converted
    rec709,      ///< ITU-R BT.709, also sRGB's
    rec2020,     ///< ITU-R BT.2020
    display_p3,  ///< P3 with the white point D65
    acescg,      ///< AP1 of ACES
    aces         ///< AP0 of ACES
};
inline constexpr std::array to_primaries_names{
    EnumName{ToPrimaries::file, "file"},       EnumName{ToPrimaries::rec709, "rec709"},
    EnumName{ToPrimaries::rec2020, "rec2020"}, EnumName{ToPrimaries::display_p3, "display-p3"},
    EnumName{ToPrimaries::acescg, "acescg"},   EnumName{ToPrimaries::aces, "aces"},
};
constexpr std::string_view name_of(ToPrimaries primaries) { return name_in(to_primaries_names, primaries); }

/// The request's `environment_settings` block.
struct EnvironmentSettings {
    EnvironmentLayout layout = EnvironmentLayout::automatic;
    LatLong latlong = LatLong::automatic;
    std::array<double, 3> rotation_deg{};  ///< active, right-handed, about world X first, then Y, then Z
    double exposure_stops = 0;             ///< radiance times 2^exposure_stops
    std::array<double, 3> tint{1, 1, 1};   ///< radiance times tint, per channel, >= 0
    InvalidRadiance invalid_radiance = InvalidRadiance::automatic;
    ToPrimaries to_primaries = ToPrimaries::file;
};

}  // namespace hairbake
