// A camera from a JSON file.
#pragma once

#include <filesystem>

#include "core/render/camera.h"

namespace hairbake {

/// Either {"eye": [x, y, z], "target": [x, y, z], "up": [x, y, z], "fov_deg": d} (look_at(); up is +Y and fov_deg 30
/// when not given) or {"target": .., "distance": .., "azimuth_deg": .., "elevation_deg": .., "fov_deg": ..} with any of
/// these (orbit_camera()). Throws Error(bad_input) naming the file for what is no JSON object, an unknown field or a
/// wrong type, Error(usage) for a value out of range.
Camera read_camera(const std::filesystem::path& file, const Vec3f& bounds_min, const Vec3f& bounds_max, double aspect);

}  // namespace hairbake
