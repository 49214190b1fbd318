// Rotates functions that are given by spherical harmonics.
#pragma once

#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/environment/environment_map.h"

namespace hairbake {

/// Coefficients of the function g with g(orthogonal * w) = f(w), where f has `coefficients`, [bands * bands]: f rotated
/// or mirrored actively by the matrix. Exact up to rounding: f is evaluated at the nodes of a quadrature that is exact
/// for its degree, and projected again. The cost grows as bands^4. Runs on all threads.
std::vector<Vec3d> rotate_sh(std::span<const Vec3d> coefficients, int bands, const Matrix3& orthogonal);

}  // namespace hairbake
