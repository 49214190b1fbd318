// The reference: transmittance traced with Embree against the true strands.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/direction_set.h"
#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"

namespace hairbake {

/// Strands as Embree round linear curves. Immutable after construction; may be traced from several threads.
class StrandScene {
public:
    /// Copies what it needs of `strands`. Throws Error(out_of_resources), Error(cancelled).
    StrandScene(const StrandGeometry& strands, Progress& progress);
    ~StrandScene();
    StrandScene(const StrandScene&) = delete;
    StrandScene& operator=(const StrandScene&) = delete;

    struct State;
    const State& state() const { return *state_; }

private:
    std::unique_ptr<State> state_;
};

/// Average over `directions` of the transmittance from each of `vertices` (indices into the strands' points):
/// the factor (1 - opacity) once per strand crossing, the vertex's own adjacent segments not counted.
/// Returns one value per entry of `vertices`, in its order; the same for any thread count.
std::vector<float> trace_transmittance(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                       std::span<const Vec3d> directions, Progress& progress);

/// For each of `vertices`, the distance from the vertex to the surface of the nearest segment that is not adjacent to it
/// (negative inside another strand), in units of the vertex's own width, at most `limit`.
std::vector<float> distance_to_other_strands(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                             float limit);

/// How far a bake is from the truth, on a sample of its vertices.
struct ErrorBar {
    std::uint32_t vertices = 0;        ///< compared
    std::uint32_t inside_strand = 0;   ///< drawn, but inside another strand: not compared
    int directions = 0;                ///< per traced vertex
    double rmse = 0;                   ///< root mean square of bake - reference
    double bias = 0;                   ///< mean of bake - reference
    double rmse_ci95[2] = {0, 0};      ///< 95 % confidence interval of rmse
    double bias_ci95[2] = {0, 0};      ///< 95 % confidence interval of bias
};

/// Traces `count` vertices drawn with `seed` in 1,024 Fibonacci directions and compares `average` ([V]) with them.
ErrorBar measure_error(const StrandScene& scene, std::span<const float> average, int count, std::uint64_t seed,
                       Progress& progress);

}  // namespace hairbake
