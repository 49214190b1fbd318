// Reads Wavefront OBJ files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// Reads the triangles of every group of an OBJ file of at most 256 MiB (it needs up to 15 times that memory).
/// positions[i] is the file's i-th `v` line, whether a face uses it or not; a polygon becomes the fan about its first
/// corner (right for convex ones); triangles that name a position twice are left out. Only v, vn and f are read: no
/// other file is opened, whatever `mtllib` says. A position's normal is the file's where all its corners name the same
/// `vn`, else that of its triangles weighted by their angles; (0, 1, 0) where no triangle gives one.
///
/// A parser of our own: tinyobjloader takes "nan" and words for 0 and wraps indices at 2^32 (4294967297 is position 1),
/// silently, and parses "1e2147483649" into a signed overflow.
///
/// Throws Error(bad_input) naming file and line: coordinates that are no numbers or beyond 1e18, faces of fewer than
/// three corners or with an index that no line before it has, a file without triangles; Error(out_of_resources).
TriangleMesh read_mesh(const std::filesystem::path& file);

/// The same from memory; `name` stands for the file in messages. This is what the fuzzer calls.
TriangleMesh read_mesh(std::span<const std::byte> bytes, const std::string& name);

}  // namespace hairbake
