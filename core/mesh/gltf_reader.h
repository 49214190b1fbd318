// Reads glTF 2.0 files. Private to core/mesh.
#pragma once

#include "core/mesh/mesh_reader.h"

namespace hairbake {

/// Both read what the default scene shows (without one: the first scene; without scenes: all nodes that are no child):
/// the triangles, strips and fans of its nodes' meshes, with the nodes' transforms. Lengths are not scaled.
/// - The order of positions is that of the nodes, depth first, each with its primitives. Primitives of a node that share
///   their positions share them here, too.
/// - Skins and morph targets are not applied, with a warning. Points and lines are left out, with a warning.
/// - Refused are compressed geometry and other required extensions that change it, sparse accessors, and buffers in other
///   files: the digest of the bake's input covers one file.
/// tinygltf parses; every index and range is checked here again.
extern const MeshReader glb_reader;   ///< binary, ".glb"
extern const MeshReader gltf_reader;  ///< JSON with embedded buffers, ".gltf"

}  // namespace hairbake
