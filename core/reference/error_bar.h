// The error bar of a bake: its transmittance against the traced reference at some of its vertices (docs/math.md, "Error
// bars").
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/reference/strand_scene.h"

namespace hairbake {

/// Statistics of bake - reference over some vertices.
struct ErrorFigures {
    std::uint32_t vertices = 0;  ///< compared
    /// Root mean square error of the reference itself, which comes from its finite number of directions.
    double noise = 0;
    double rmse = 0;  ///< noise taken off: sqrt(max(0, mean square - noise^2))
    double bias = 0;
    std::array<double, 2> rmse_ci95{};  ///< 95 % confidence interval of rmse (normal approximation of the mean square)
    std::array<double, 2> bias_ci95{};  ///< 95 % confidence interval of bias
};

/// The error bar of a bake, over a random sample of its vertices. A vertex inside another strand is not compared: the
/// reference is ill-defined there.
struct ErrorBar {
    ErrorFigures outside;             ///< vertices outside other strands
    ErrorFigures clear;               ///< those of them that are at least one width away from other strands
    std::uint32_t inside_strand = 0;  ///< drawn, not compared
    int directions = 0;               ///< traced per vertex
};

/// The transmittance of the same vertices, traced with two halves of the directions.
struct TracedHalves {
    std::vector<float> first, second;

    /// The mean of the two halves.
    std::vector<float> mean() const;
};

/// Statistics of `baked` - mean of `traced`, all of one size. The noise is half of the root mean square difference of
/// the two halves: their errors are independent and of the same size.
ErrorFigures error_statistics(std::span<const float> baked, const TracedHalves& traced);

/// Statistics against a reference without noise.
ErrorFigures error_statistics(std::span<const float> baked, std::span<const float> traced);

/// The directions of the reference: two halves of 2,048 Fibonacci directions each, turned by two fixed rotations, so
/// that no bake uses a set like them.
inline constexpr int reference_directions = 4096;
std::array<std::vector<Vec3d>, 2> make_reference_directions();

/// Traces `vertices` in the reference directions.
/// Throws Error(cancelled).
TracedHalves trace_reference(const StrandScene& scene, std::span<const std::uint32_t> vertices, Progress& progress);

/// The truth at a random sample of a model's vertices, to which several bakes of the model can be compared.
class ErrorReference {
public:
    /// Traces the sample in the reference directions.
    ///
    /// count: vertices to draw; all vertices where the model has no more
    /// seed:  of the draw
    ///
    /// Throws Error(cancelled).
    ErrorReference(const StrandScene& scene, int count, std::uint64_t seed, Progress& progress);

    /// The vertices outside other strands, ascending: those at which bakes are compared.
    std::span<const std::uint32_t> vertices() const { return outside_; }

    /// average: [V], of a bake; only its values at vertices() are read
    ErrorBar compare(std::span<const float> average) const;

private:
    std::size_t vertex_count_;
    std::vector<std::uint32_t> outside_;  // vertices
    std::vector<std::uint32_t> clear_;    // places in outside_
    std::uint32_t inside_strand_ = 0;
    TracedHalves traced_;  // at outside_
};

/// ErrorReference for a single bake.
/// Throws Error(cancelled).
ErrorBar measure_error(const StrandScene& scene, std::span<const float> average, int count, std::uint64_t seed,
                       Progress& progress);

}  // namespace hairbake
