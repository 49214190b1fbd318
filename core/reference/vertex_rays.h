// Transmittance of single rays from vertices of the hair.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/mesh/grounding.h"
#include "core/reference/strand_scene.h"

namespace hairbake {

/// Traces single rays by the rules of trace_transmittance (tracer.h). That function is faster for many vertices in one
/// direction; this class is for directions that differ from vertex to vertex. Immutable: thread-safe.
class VertexRays {
public:
    /// Finds the vertices that lie on the scene's occluder. `scene` must outlive this object.
    /// Throws Error(cancelled).
    VertexRays(const StrandScene& scene, Progress& progress);

    /// Transmittance of `vertex` in `direction` (unit), in [0, 1]: the same value as
    /// trace_transmittance(scene, {vertex}, {direction}).
    float transmittance(std::uint32_t vertex, const Vec3d& direction) const;

private:
    bool past_occluder(std::uint32_t vertex, const Vec3f& l) const;

    const StrandScene& scene_;
    bool opaque_;
    std::vector<GroundedPoint> grounded_;  // ascending
};

}  // namespace hairbake
