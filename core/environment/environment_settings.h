// The request's `environment_settings` block: how an environment is read.
#pragma once

#include <array>
#include <string>

namespace hairbake {

/// Which direction the columns of a lat-long map look along. Row 0 is +Y in all of them.
enum class LatLong {
    gltf,      ///< centre column +X, right of it +Z (three.js, glTF)
    filament,  ///< centre +Z, right of it +X: a mirror image in this frame, which is what the name asks for
    openexr    ///< centre +Z, right of it -X
};

enum class InvalidRadiance {
    reject,  ///< a negative, infinite or NaN pixel is an error naming it
    clamp    ///< negative and NaN become 0, +infinity the largest finite value of the map; counted (-infinity: 0)
};

/// The request's `environment_settings` block.
struct EnvironmentSettings {
    std::string layout = "auto";  ///< auto, latlong, faces, {horizontal,vertical}_{cross,strip}
    LatLong latlong = LatLong::gltf;
    std::array<double, 3> rotation_deg{};  ///< active, right-handed, about world X first, then Y, then Z
    double exposure_stops = 0;             ///< radiance times 2^exposure_stops
    std::array<double, 3> tint{1, 1, 1};   ///< radiance times tint, per channel, >= 0
    InvalidRadiance invalid_radiance = InvalidRadiance::reject;
};

}  // namespace hairbake
