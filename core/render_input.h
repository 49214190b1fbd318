// Everything that a picture is made of, read and baked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/environment/environment_map.h"
#include "core/hair/hair_model.h"
#include "core/irradiance/irradiance_maps.h"
#include "core/mesh/triangle_mesh.h"
#include "core/render.h"

namespace hairbake {

struct RenderInput {
    BakeRequest bake;  ///< as it ran; paths as they were read
    HairModel hair;
    std::optional<EnvironmentMap> environment;  ///< where mode, background or mesh need it
    std::optional<TriangleMesh> mesh;           ///< shown
    std::optional<TriangleMesh> occluder;       ///< stops light, with mode reference
    std::vector<float> average;                 ///< [V]
    std::vector<float> sh, bent_cone;
    std::optional<IrradianceMaps> maps;  ///< with mode baked, where the picture shows light
    std::vector<std::string> warnings;
};

/// Whether the picture needs light on the hair: the mode baked shows transmittance and tangents without any.
bool shows_light(const RenderRequest& request);

/// Reads the result folder, or bakes in memory what the mode needs. Throws as render().
RenderInput read_render_input(const RenderRequest& request, BakeProgress& progress);

}  // namespace hairbake
