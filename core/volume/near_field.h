// Near-field correction: what the grid smears out within a voxel's reach of a vertex is put right with the true
// strands.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"
#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/strand_pieces.h"

namespace hairbake {

/// First angular moments of the transmittance at a vertex: T(l) is about max(0, average + slope . l).
struct AngularMean {
    float average;  ///< A = mean of T over the directions
    Vec3f slope;    ///< 3 * mean of T l
};

/// Corrected average transmittance of every vertex ([V], in the model's order, from `means` [V] in the order of
/// `sorted`): A exp(F_grid - F_exact + own), at most 1.
///
/// F is the mean over directions, weighted with T(l) / A, of the optical depth within the window q(d) = (1 - d^2 /
/// r^2)^2, r = 0.5 voxels: F_exact of the strand pieces (in closed form along each piece; the vertex's adjacent
/// segments left out; never nearer than half of the width), F_grid of the voxels. `own` takes out what the
/// vertex's own strand adds to the grid beyond the window: half of it at a strand's end, nothing at a lone point.
/// Design, "What a spike measured"; the closed form and the smaller window are ours.
std::vector<float> correct_near_field(const StrandGeometry& strands, const GridFrame& frame,
                                      const SortedStrands& sorted, const ExtinctionBricks& bricks,
                                      std::span<const AngularMean> means, Progress& progress);

}  // namespace hairbake
