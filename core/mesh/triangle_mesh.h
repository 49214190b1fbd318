// A triangle mesh: an occluder, which hides hair from light, or a receiver, which hair shadows.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"

namespace hairbake {

/// Triangles over shared positions, in the model's unit and frame; counter-clockwise seen from outside.
struct TriangleMesh {
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;  ///< outward unit normals, one for each position
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace hairbake
