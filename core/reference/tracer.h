// The reference: transmittance traced with Embree against the true strands (docs/math.md, "The traced reference").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/mesh/triangle_mesh.h"
#include "core/reference/strand_scene.h"
#include "core/visibility/direction_moments.h"
#include "core/visibility/direction_weights.h"

namespace hairbake {

/// Average transmittance of each of `vertices` over `directions`, in [0, 1], in the order of `vertices`.
///
/// vertices:   indices of the strands' points; fastest when neighbours in the list are neighbours in space (packets of
///             16 share a direction)
/// directions: unit vectors away from the hair
///
/// The transmittance of a ray is the product of (1 - opacity) over the strands that it crosses, once per crossing and
/// not per segment or joint. The vertex's own strand is left out: its adjacent segments do not count, nor segments that
/// the ray enters before it has left the vertex's own strand. The transmittance is 0 where the scene's occluder is in
/// the way. Both sides of the occluder block. Rays of vertices on its surface start where core/mesh/grounding.h says.
/// The same for any thread count.
/// Throws Error(cancelled).
std::vector<float> trace_transmittance(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                       std::span<const Vec3d> directions, Progress& progress);

/// The same with all results of DirectionalMeans. sh_bands: 0 to 4.
DirectionalMeans trace_directional(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                   std::span<const Vec3d> directions, int sh_bands, bool bent_cone, Progress& progress);

/// [vertices * components], the sums of DirectionWeights at `vertices`, in their order, for as many directions as
/// `weights` has. weights.rows has a row for every vertex of the scene.
std::vector<float> trace_weighted(const StrandScene& scene, std::span<const std::uint32_t> vertices,
                                  std::span<const Vec3d> directions, const DirectionWeights& weights,
                                  Progress& progress);

/// [R * 2]: mean transmittance over the hemisphere at the positions of `receiver`, plain and cosine-weighted
/// (HemisphereSums). Directions below a point's plane are not traced. A point has no strand of its own: inside a strand
/// everything is blocked. The receiver shadows nothing; with `receiver_is_occluder` the scene's occluder shadows
/// nothing either.
std::vector<float> trace_receiver(const StrandScene& scene, const TriangleMesh& receiver, bool receiver_is_occluder,
                                  std::span<const Vec3d> directions, Progress& progress);

}  // namespace hairbake
