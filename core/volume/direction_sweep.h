// Sweeps all directions, axis by axis, and adds up what every reader takes from them.
#pragma once

#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/volume/fixed_point_sums.h"
#include "core/volume/hair_volume.h"
#include "core/volume/sweep_reader.h"

namespace hairbake {

/// Returns the sums of each of `readers`, in their order. Readers with the same point set share its transmittance.
///
/// directions: unit vectors away from the hair; readers know them by their index
/// readers:    may be of any number of point sets
///
/// The same bits for any thread count.
/// Throws Error(out_of_resources), Error(cancelled).
std::vector<FixedPointSums> sweep_directions(const HairVolume& volume, std::span<const Vec3d> directions,
                                             std::span<const SweepReader* const> readers, Progress& progress);

}  // namespace hairbake
