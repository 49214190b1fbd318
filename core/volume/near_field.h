// Near-field correction: replaces the grid's blurred optical depth near a vertex by that of the nearby strands.
#pragma once

#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"
#include "core/volume/hair_volume.h"

namespace hairbake {

/// First angular moments of the transmittance at a vertex: T(l) is about max(0, average + slope . l).
struct AngularMean {
    float average;  ///< A = mean of T over the directions
    Vec3f slope;    ///< 3 * mean of T l
};

/// A vertex has at most this many means (of different lights or extinctions).
constexpr std::size_t kMostMeans = 4;

/// Corrected averages of every vertex: [means][V], in the model's order. One pass over the strands near the vertices
/// serves all means; each is corrected on its own.
///
/// volume: made of `strands`
/// means:  [means][V], as swept, each in the order of volume.sorted.vertices; at most kMostMeans
///
/// The corrected average is A exp(F_grid - F_exact + own), at most 1. F is the optical depth within the window q(d) =
/// (1 - d^2 / r^2)^2, r = 0.5 voxels. It is a mean over the directions with the weight T(l) / A. There are two such
/// depths:
/// - F_exact of the strand pieces, in closed form along each piece. The vertex's adjacent segments are left out. The
///   distance is never less than half of the width.
/// - F_grid of the voxels.
/// Nothing is corrected where A is small (NearFieldWindow::share). `own` removes what the vertex's own strand takes in
/// the sweep outside F_grid (own_shadow.h). See docs/math.md, "The near field".
///
/// The same bits for any thread count.
/// Throws Error(cancelled).
std::vector<std::vector<float>> correct_near_field(const StrandGeometry& strands, const HairVolume& volume,
                                                   std::span<const std::vector<AngularMean>> means,
                                                   const Progress& progress);

}  // namespace hairbake
