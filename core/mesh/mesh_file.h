// Reads Wavefront OBJ files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// Reads the triangles of every group of an OBJ file; polygons are cut into triangles. positions[i] is the file's i-th
/// `v` line. Throws Error(bad_input) naming the file, where in it, what was found and what is allowed.
TriangleMesh read_mesh(const std::filesystem::path& file);

/// The same from memory; `name` stands for the file in messages. This is what the fuzzer calls.
TriangleMesh read_mesh(std::span<const std::byte> bytes, const std::string& name);

}  // namespace hairbake
