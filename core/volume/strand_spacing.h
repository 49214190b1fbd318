// How far apart the strands of a model are.
#pragma once

#include "core/base/progress.h"
#include "core/hair/strand_geometry.h"

namespace hairbake {

/// The mean distance between neighbouring strands, in model units: sqrt(V / L). V is the volume of the cells that
/// strands pass, in a lattice with 32 cells on the longest side of the bounds, and L the length of all solid segments.
/// Parallel strands in a square lattice of this distance fill V with the length L. 0 for a model without solid
/// segments. The same for any thread count.
/// Throws Error(cancelled).
double strand_spacing(const StrandGeometry& strands, const Progress& progress);

}  // namespace hairbake
