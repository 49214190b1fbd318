// Weighted sums of the transmittance over given directions, by the volume method.
#pragma once

#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/visibility/direction_weights.h"
#include "core/volume/transmittance.h"

namespace hairbake {

/// [V * components], the sums of DirectionWeights at every vertex, in the model's order, with T of the mean field along
/// exactly these directions.
///
/// scene:      hair and occluder; the receiver is not read
/// settings:   the voxels
/// directions: unit vectors away from the hair, weights.directions of them
///
/// A single direction cannot have the near-field correction, which is a mean over all directions. What the vertex's own
/// strand takes in the sweep, averaged over directions, is given back: the sums are multiplied by exp of that depth
/// (own_shadow.h).
/// Deterministic bit for bit for any thread count; values agree to 1e-5 between SIMD targets.
/// Throws what bake_transmittance_volume throws.
std::vector<float> sum_weighted_volume(const TransmittanceScene& scene, const TransmittanceSettings& settings,
                                       std::span<const Vec3d> directions, const DirectionWeights& weights,
                                       Progress& progress);

}  // namespace hairbake
