// One ray from a vertex of the hair.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/reference/strand_scene.h"

namespace hairbake {

/// Traces single rays by the rules of trace_transmittance (tracer.h), which is faster for many vertices in one
/// direction; this is for directions that differ. Refers to the scene. One object a thread.
class VertexRay {
public:
    explicit VertexRay(const StrandScene& scene);

    /// Transmittance seen from `vertex` in `direction` (unit), in [0, 1]: the same as
    /// trace_transmittance(scene, {vertex}, {direction}).
    float transmittance(std::uint32_t vertex, const Vec3d& direction);

private:
    const StrandScene& scene_;
    bool opaque_;
    std::vector<std::uint32_t> hit_;
};

}  // namespace hairbake
