// Pictures of hair under an environment.
#pragma once

#include <span>
#include <vector>

#include "core/base/progress.h"
#include "core/environment/environment_map.h"
#include "core/render/camera.h"
#include "core/render/fiber_lighting.h"
#include "core/render/first_hit.h"
#include "core/render/frame_settings.h"

namespace hairbake {

/// The content of a picture. Refers to its parts, which must outlive it.
struct RenderScene {
    const FirstHits& hits;
    std::span<const Vec3f> tangents;  ///< [V], unit, root to tip (hair/tangents.h)
    const StrandGeometry& strands;
    const FiberLighting& lighting;
    std::span<const FiberLobe> lobes;            ///< of the fibre model
    Vec3d kd, ks;                                ///< RGB; Kd = albedo / pi^2 sends on the share `albedo` of the light
    const LightSum* mesh_lights = nullptr;       ///< light the mesh; null: it is black
    Vec3d mesh_albedo;                           ///< Lambertian, lit by the environment; receives no shadows
    const EnvironmentMap* background = nullptr;  ///< nearest texel; null: black
};

/// The pixels, [height * width], rows from the top. In other channels than beauty, mesh and background are 0; the mesh
/// still hides hair behind it. Runs on all threads in tiles; the same arguments give the same bytes for any number of
/// threads. `progress` reports 0 to 1.
/// Throws Error(cancelled).
std::vector<Vec3f> render_frame(const RenderScene& scene, const Camera& camera, const FrameSettings& settings,
                                Progress& progress);

}  // namespace hairbake
