// The published way to SH irradiance maps: the transfer matrix of Xing 2012, equation 11.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/environment/environment_map.h"

namespace hairbake::testing {

/// Returns the sum over i < bands^2 of w_i F_i(t) for each tangent t, by brute force in double. F_i(t) is the sum over
/// every texel of Y_i(w) K(t . w) * solid angle, and w_i is the sum of L Y_i * solid angle (equation 10). `kernel`
/// gives K from the cosine of the angle to the tangent.
std::vector<Vec3d> transfer_matrix_map(const EnvironmentMap& map, std::span<const Vec3d> tangents, int bands,
                                       const std::function<double(double cosine)>& kernel);

}  // namespace hairbake::testing
