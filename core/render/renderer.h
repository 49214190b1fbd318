// Pictures of hair under an environment.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"
#include "core/render/camera.h"
#include "core/render/fiber_lighting.h"
#include "core/render/first_hit.h"

namespace hairbake {

/// What a pixel shows.
enum class Channel {
    beauty,         ///< linear radiance: diffuse + specular on hair, the mesh, the background
    transmittance,  ///< FiberLight::transmittance, in all three channels
    diffuse,        ///< the beauty's diffuse part on hair, Kd applied
    specular,       ///< its specular part, Ks applied
    tangent         ///< the strand's tangent, each component in [-1, 1]
};

/// Everything that is in the picture. Refers to its parts, which must outlive it.
struct RenderScene {
    const FirstHits& hits;
    std::span<const Vec3f> tangents;  ///< [V], unit, root to tip (hair/tangents.h)
    const StrandGeometry& strands;
    const FiberLighting& lighting;
    Vec3d kd, ks;                                ///< RGB; Kd = albedo / pi^2 sends on the share `albedo` of the light
    const LightSum* mesh_lights = nullptr;       ///< light the mesh; null: it is black
    Vec3d mesh_albedo;                           ///< Lambert, lit by the environment, in nobody's shadow
    const EnvironmentMap* background = nullptr;  ///< nearest texel; null: black
};

struct FrameSettings {
    int width = 0, height = 0;  ///< 1 to 16384 each
    int samples = 1;            ///< of a pixel, 1 to 65536; box filter
    std::uint64_t seed = 1;
    Channel channel = Channel::beauty;
};

/// [height * width], rows from the top. In other channels than beauty all that is no hair is 0, and the mesh still
/// hides hair. Runs on all threads in tiles; the same arguments give the same bytes for any number of them. Reports the
/// stage "render". Throws Error(cancelled).
std::vector<Vec3f> render_frame(const RenderScene& scene, const Camera& camera, const FrameSettings& settings,
                                Progress& progress);

}  // namespace hairbake
