// How far a bake is from the truth, measured by every bake on itself.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/progress.h"
#include "core/reference/strand_scene.h"

namespace hairbake {

/// Statistics of bake - reference over a random sample of vertices.
struct ErrorBar {
    std::uint32_t vertices = 0;  ///< compared
    std::uint32_t inside_strand =
        0;               ///< drawn, but inside another strand, where the reference is ill-defined: not compared
    int directions = 0;  ///< traced per vertex
    double rmse = 0;
    double bias = 0;
    std::array<double, 2> rmse_ci95{};  ///< 95 % confidence interval of rmse (normal approximation of the mean square)
    std::array<double, 2> bias_ci95{};  ///< 95 % confidence interval of bias
};

/// Statistics of `baked` - `traced`, sizes equal; counts and directions are left to the caller.
ErrorBar error_statistics(std::span<const float> baked, std::span<const float> traced);

/// Traces `count` vertices drawn with `seed` (all vertices when there are no more than `count`) in 1,024 Fibonacci
/// directions and compares `average` ([V]) with them.
ErrorBar measure_error(const StrandScene& scene, std::span<const float> average, int count, std::uint64_t seed,
                       Progress& progress);

}  // namespace hairbake
