// A camera from a JSON file.
#pragma once

#include <filesystem>

#include "core/render/camera.h"

namespace hairbake {

/// Either {"eye": [x, y, z], "target": [x, y, z], "up": [x, y, z], "fov_deg": d} (look_at(); up is +Y and fov_deg 30 by
/// default), or {"target": .., "distance": .., "azimuth_deg": .., "elevation_deg": .., "fov_deg": ..} with any of these
/// fields (orbit_camera()).
///   file                    JSON, at most 64 KiB
///   bounds_min, bounds_max  of the hair and the mesh, for an orbit
///   aspect                  width over height of the picture
/// Throws Error(bad_input) naming the file where it is no JSON object or has an unknown field or a wrong type.
/// Throws Error(usage) for a value out of range.
Camera read_camera(const std::filesystem::path& file, const Vec3f& bounds_min, const Vec3f& bounds_max, double aspect);

}  // namespace hairbake
