// The strand's tangent at every vertex. The irradiance maps are looked up by it at run time.
#pragma once

#include <vector>

#include "core/hair/hair_model.h"

namespace hairbake {

/// [V] unit tangents from root to tip, in model space. Thread-safe.
/// - Inside a strand: from the last point before the vertex to the first point after it. Points at the place of the
///   vertex are skipped.
/// - At the ends: from or to the vertex itself.
/// - Where a strand turns back on itself exactly: from the vertex to the point after it.
/// - (0, 0, 0) at every vertex of a strand whose points all coincide.
std::vector<Vec3f> vertex_tangents(const HairModel& model);

}  // namespace hairbake
