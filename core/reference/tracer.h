// The reference: transmittance traced with Embree against the true strands.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/mesh/triangle_mesh.h"
#include "core/reference/strand_scene.h"
#include "core/visibility/direction_moments.h"

namespace hairbake {

/// Average over `directions` of the transmittance seen from each of `vertices` (indices of the strands' points): the
/// factor (1 - opacity) once per strand crossing, not per segment or joint; the vertex's own adjacent segments, and
/// those that a ray enters before it has left the vertex's own strand, are not counted (spec section 3, self
/// exclusion), and 0 where the scene's occluder is in the way (both its sides block; vertices on its surface look from
/// where core/mesh/grounding.h says). One value in [0, 1] per entry of `vertices`, in its order, the same for any
/// thread count. Fastest when neighbouring entries are neighbours in space (packets of 16 share a direction).
std::vector<float> trace_transmittance(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                       std::span<const Vec3d> directions, Progress& progress);

/// The same with the directional answers of DirectionalMeans: `sh_bands` in [0, 4], and bent cones.
DirectionalMeans trace_directional(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                   std::span<const Vec3d> directions, int sh_bands, bool bent_cone, Progress& progress);

/// [R * 2]: what the positions of `receiver` see of the hemisphere about their normals, plain and cosine-weighted
/// (HemisphereSums); the directions below a point's plane are not traced. A point has no strand of its own: inside a
/// strand it sees nothing. The receiver itself shadows nothing, and with `receiver_is_occluder` the scene's occluder
/// does not either.
std::vector<float> trace_receiver(const StrandScene& scene, const TriangleMesh& receiver, bool receiver_is_occluder,
                                  std::span<const Vec3d> directions, Progress& progress);

}  // namespace hairbake
