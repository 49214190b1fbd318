// The numbers that a glTF accessor names. Private to core/mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/vec.h"

namespace tinygltf {
class Model;
}

namespace hairbake {

/// The values of accessor `index`, VEC3 of floats, or of integers as KHR_mesh_quantization has them.
/// Throws Error(bad_input) naming file and accessor: an index or range outside its array, another type, a sparse
/// accessor.
std::vector<Vec3d> gltf_vectors(const tinygltf::Model& model, int index, const std::string& name);

/// The values of accessor `index`, unsigned SCALARs.
/// Throws the same.
std::vector<std::uint32_t> gltf_indices(const tinygltf::Model& model, int index, const std::string& name);

}  // namespace hairbake
