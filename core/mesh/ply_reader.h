// Reads PLY files. Private to core/mesh.
#pragma once

#include "core/mesh/mesh_reader.h"

namespace hairbake {

/// Reads version 1.0, as text and binary in both byte orders. Takes from the element `vertex` the properties x, y, z and
/// nx, ny, nz, from `face` the list `vertex_indices` or `vertex_index`, and triangle strips (`tristrips`, -1 begins a new
/// one). Other elements and properties are skipped.
///
/// The reader is our own: Debian packages no small one, and the PLY readers of its large libraries (assimp, OpenMesh,
/// draco) take memory for as many elements as a header claims, or lack a byte order.
extern const MeshReader ply_reader;

}  // namespace hairbake
