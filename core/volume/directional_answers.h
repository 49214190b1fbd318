// From the sweep's sums to what a bake gives.
#pragma once

#include <span>
#include <vector>

#include "core/base/direction_moments.h"
#include "core/volume/direction_sweep.h"
#include "core/volume/near_field.h"

namespace hairbake {

/// A and slope of every vertex as swept, for the near-field correction; [V] in the order of SortedStrands.
std::vector<AngularMean> angular_means(const ItemSums& vertices, std::size_t directions);

/// SH coefficients and bent cones of every vertex, [V] in the model's order (vertices_of is SortedStrands::vertices),
/// in agreement with the corrected averages `average` (which go into the answer): the sweep's moments, changed as the
/// near-field correction changed A. Where A fell from a to A, every moment is multiplied by A / a: the hair that
/// the grid did not see lies on all sides of the vertex. Where A rose, (1 - A) / (1 - a): what was blocked too much,
/// the vertex's own strand above all, is given back evenly, so that T stays within [0, 1] and all that is left where A
/// = 1 is the mean.
DirectionalMeans directional_answers(const ItemSums& vertices, std::span<const std::uint32_t> vertices_of,
                                     std::vector<float> average, std::size_t directions, int sh_bands, bool bent_cone);

/// [R * 2], means over the hemisphere, plain and cosine-weighted (HemisphereSums). The near field is left to the grid:
/// a point of a surface has no strand of its own, and hair that grows from the surface leaves it within a voxel.
/// `without_direction` counts the points above whose plane no direction of the set lies.
std::vector<float> receiver_answers(const ItemSums& receivers, std::size_t* without_direction);

}  // namespace hairbake
