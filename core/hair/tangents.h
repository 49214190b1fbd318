// The strand's tangent at every vertex: what the run time looks the irradiance maps up by.
#pragma once

#include <vector>

#include "core/hair/hair_model.h"

namespace hairbake {

/// [V] unit tangents from root to tip. At a vertex it is the direction from the last point of its strand before it that
/// lies elsewhere to the first one after it that does; at the ends of a strand, from or to the vertex itself; and where
/// a strand turns back on itself exactly, to the point after. (0, 0, 0) at every vertex of a strand whose points are
/// all one, which has no direction. In model space. Thread-safe.
std::vector<Vec3f> vertex_tangents(const HairModel& model);

}  // namespace hairbake
