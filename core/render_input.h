// The inputs of a picture, read and baked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/environment/environment_map.h"
#include "core/hair/hair_model.h"
#include "core/irradiance/irradiance_maps.h"
#include "core/mesh/triangle_mesh.h"
#include "core/render/render_request.h"

namespace hairbake {

struct RenderInput {
    BakeRequest bake;  ///< as baked, with the paths that were read
    HairModel hair;
    std::optional<EnvironmentMap> environment;  ///< where mode, background or mesh need it
    std::optional<TriangleMesh> mesh;           ///< shown
    std::optional<TriangleMesh> occluder;       ///< blocks light, with mode reference
    std::vector<float> average;                 ///< [V]
    std::vector<float> sh, bent_cone, effective;
    std::optional<IrradianceMaps> maps;  ///< with a mode that uses maps, where the picture shows light
    std::vector<std::string> warnings;
};

/// Checks what read_render_input() reads, as far as the headers of the files tell.
/// Throws the same errors with the same words.
void check_render_input(const RenderRequest& request);

/// Reads the result folder, or bakes in memory the stages that the mode needs. The environment is decoded once.
/// Throws the errors of render().
RenderInput read_render_input(const RenderRequest& request, BakeProgress& progress);

}  // namespace hairbake
