// From the sweep's sums to what a bake gives.
#pragma once

#include <span>
#include <vector>

#include "core/visibility/direction_moments.h"
#include "core/volume/direction_sweep.h"
#include "core/volume/near_field.h"

namespace hairbake {

/// A and slope of every vertex as swept, for the near-field correction; [V] in the order of SortedStrands.
std::vector<AngularMean> angular_means(const ItemSums& vertices, std::size_t directions);

/// SH coefficients and bent cones of every vertex, [V] in the model's order (vertices_of is SortedStrands::vertices),
/// in agreement with the corrected averages `average` (which go into the answer): the near-field correction multiplies
/// T of every direction by the factor that it gave A, so every moment of a vertex is multiplied by it, and bent cones
/// stay as swept. (What lies within half a voxel lies on all sides in the mean. RMSE of band 1 at 200,000 curly
/// vertices: 0.0638 so, 0.0665 with the moments left alone, 0.0699 with what is given back spread evenly, so that no T
/// exceeds 1; bands 2 and 3 hardly differ. Those errors are nearly the same in all bands, as the noise of single
/// strands is.)
DirectionalMeans directional_answers(const ItemSums& vertices, std::span<const std::uint32_t> vertices_of,
                                     std::vector<float> average, std::size_t directions, int sh_bands, bool bent_cone);

/// [R * 2], means over the hemisphere, plain and cosine-weighted (HemisphereSums). The near field is left to the grid:
/// a point of a surface has no strand of its own, and hair that grows from the surface leaves it within a voxel.
/// `without_direction` counts the points above whose plane no direction of the set lies.
std::vector<float> receiver_answers(const ItemSums& receivers, std::size_t* without_direction);

}  // namespace hairbake
