// The error bar of effective transmittance: light that arrives, over small neighbourhoods of visible vertices.
//
// At a single vertex the true transmittance of a lamp is 0 or 1, so an error of single vertices says nothing about a
// picture. A pixel shows many strands: what counts is the mean over a neighbourhood.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/reference/strand_scene.h"
#include "core/visibility/direction_weights.h"

namespace hairbake {

/// Statistics of the light of a bake against the traced light, over neighbourhoods.
struct NeighborhoodFigures {
    double bias = 0;  ///< mean of baked - traced, divided by the mean of traced
    std::array<double, 2> bias_ci95{};
    double slope = 0;  ///< of the least squares line of traced over baked: 1 is right, below 1 has too much contrast
    std::array<double, 2> slope_ci95{};
    double rmse = 0;  ///< of the neighbourhoods, divided by the mean of traced; holds the noise of 32 traced vertices
};

struct NeighborhoodError {
    std::uint32_t neighborhoods = 0;  ///< compared
    std::uint32_t vertices = 0;       ///< traced
    NeighborhoodFigures effective;
    NeighborhoodFigures average;  ///< of the published product: A times the light that would arrive unblocked
};

/// Vertices of a neighbourhood.
inline constexpr std::size_t neighborhood_size = 32;

/// Draws vertices that are visible from outside in one of 26 directions, and takes around each the 32 vertices nearest
/// to it, without those that lie inside other strands. Traces each under the lights of the bake, and in 100 Fibonacci
/// directions for A.
///
/// directions: of the lights
/// light:      one component: the unblocked light of each direction at each cell of tangents
/// baked:      [V], the light of the bake
/// count:      neighbourhoods to draw
/// seed:       of the draw
///
/// Fewer are compared where fewer than `count` drawn vertices are visible. The same for any thread count.
/// Throws Error(cancelled).
NeighborhoodError measure_neighborhoods(const StrandScene& scene, std::span<const Vec3d> directions,
                                        const DirectionWeights& light, std::span<const float> baked, int count,
                                        std::uint64_t seed, Progress& progress);

/// Bias and slope of `baked` against `traced`, of one size; all 0 with fewer than three.
NeighborhoodFigures neighborhood_figures(std::span<const double> baked, std::span<const double> traced);

}  // namespace hairbake
