// Single rays from vertices of the hair.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/base/vec.h"
#include "core/mesh/grounding.h"
#include "core/reference/strand_scene.h"

namespace hairbake {

/// Traces single rays by the rules of trace_transmittance (tracer.h), which is faster for many vertices in one
/// direction; this is for directions that differ. Refers to the scene. Immutable: thread-safe.
class VertexRays {
public:
    /// Finds the vertices that lie on the scene's occluder. Throws Error(cancelled).
    VertexRays(const StrandScene& scene, Progress& progress);

    /// Transmittance seen from `vertex` in `direction` (unit), in [0, 1]: the same as
    /// trace_transmittance(scene, {vertex}, {direction}).
    float transmittance(std::uint32_t vertex, const Vec3d& direction) const;

private:
    bool past_occluder(std::uint32_t vertex, const Vec3f& l) const;

    const StrandScene& scene_;
    bool opaque_;
    std::vector<GroundedPoint> grounded_;  // in ascending order
};

}  // namespace hairbake
