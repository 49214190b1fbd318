// The triangles that a glTF scene shows. Private to core/mesh.
#pragma once

#include <string>

#include "core/mesh/polygon_mesh.h"

namespace tinygltf {
class Model;
}

namespace hairbake {

/// Reads the default scene, as gltf_reader.h says. `name` stands for the file in messages; `format` is that of the result.
/// Throws Error(bad_input) for a node, mesh or accessor that does not exist, a node with two parents, coordinates beyond
/// 1e18, and a scene without triangles.
PolygonFile read_gltf_scene(const tinygltf::Model& model, const std::string& name, const char* format);

}  // namespace hairbake
