// What is doubtful about strands, for the person who asked for the bake.
#pragma once

#include <string>
#include <vector>

#include "core/hair/strand_geometry.h"

namespace hairbake {

/// A sentence for each of these that holds:
/// - the model has no vertex;
/// - strands have the same points as another strand: all but one lie inside it, where A is 0 by the tracer;
/// - the strands lie so far from the origin that single precision loses their places: farther than 1e5 times their
/// size. The same for any thread count.
std::vector<std::string> strand_warnings(const StrandGeometry& strands);

}  // namespace hairbake
