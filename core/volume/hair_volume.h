// The hair as the volume method sees it: the voxels' frame, the strands sorted into bricks, and the extinction.
#pragma once

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"
#include "core/visibility/transmittance_settings.h"
#include "core/volume/extinction_bricks.h"
#include "core/volume/grid_frame.h"
#include "core/volume/strand_pieces.h"

namespace hairbake {

/// Everything that stops light, built once for a bake. The sweep, the near-field correction and the density grid read
/// it. `sorted.bricks` numbers the bricks of both `sorted` and `bricks`. Immutable after construction: thread-safe.
struct HairVolume {
    GridFrame frame;
    SortedStrands sorted;
    ExtinctionBricks bricks;
};

/// Builds the volume of `strands` (at least one vertex) with the voxels that `settings` ask for.
/// Throws what make_grid_frame and sort_strands throw, Error(cancelled).
HairVolume make_hair_volume(const StrandGeometry& strands, const TransmittanceSettings& settings, Progress& progress);

}  // namespace hairbake
