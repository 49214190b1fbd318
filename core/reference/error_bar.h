// The error bar of a bake: its transmittance against the traced reference at some of its vertices (docs/math.md, "Error
// bars").
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/progress.h"
#include "core/reference/strand_scene.h"

namespace hairbake {

/// Statistics of bake - reference over a random sample of vertices.
struct ErrorBar {
    std::uint32_t vertices = 0;       ///< compared
    std::uint32_t inside_strand = 0;  ///< drawn, not compared: inside another strand the reference is ill-defined
    int directions = 0;               ///< traced per vertex
    double rmse = 0;
    double bias = 0;
    std::array<double, 2> rmse_ci95{};  ///< 95 % confidence interval of rmse (normal approximation of the mean square)
    std::array<double, 2> bias_ci95{};  ///< 95 % confidence interval of bias
};

/// Statistics of `baked` - `traced`, which have equal sizes. Leaves inside_strand and directions at 0.
ErrorBar error_statistics(std::span<const float> baked, std::span<const float> traced);

/// Traces some vertices in 1,024 Fibonacci directions and compares the bake with them.
///
/// average: [V], of the bake
/// count:   vertices to draw; all vertices where the model has no more
/// seed:    of the draw
///
/// Throws Error(cancelled).
ErrorBar measure_error(const StrandScene& scene, std::span<const float> average, int count, std::uint64_t seed,
                       Progress& progress);

}  // namespace hairbake
