// Reads Wavefront OBJ files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// Reads the triangles of every group of an OBJ file of at most 256 MiB (it needs up to 15 times that memory).
/// - positions[i] is the file's i-th `v` line, whether or not a face uses it.
/// - A polygon becomes the fan about its first corner, which is right for convex ones. Triangles that name a position
///   twice are left out.
/// - The normal of a position is the file's where all its corners name the same `vn`; otherwise it is the mean of its
///   triangles' normals weighted by their angles, or (0, 1, 0) where no triangle gives one.
/// - Only v, vn and f are read. No other file is opened, whatever `mtllib` says.
///
/// The parser is our own. tinyobjloader silently reads "nan" and words as 0 and wraps indices at 2^32 (4294967297 is
/// position 1), and "1e2147483649" makes it overflow a signed integer.
///
/// Throws Error(bad_input) naming file and line: coordinates that are no numbers or beyond 1e18, faces of fewer than
/// three corners or with an index that no line before has defined, a file without triangles.
/// Throws Error(out_of_resources) when memory ends.
TriangleMesh read_mesh(const std::filesystem::path& file);

/// Checks what read_mesh() checks before it reads: the file is there, can be opened, is a regular file and not too
/// long.
/// Throws the same errors with the same words.
void check_mesh(const std::filesystem::path& file);

/// The same as read_mesh() from memory; `name` stands for the file in messages. The fuzzer calls this one.
TriangleMesh read_mesh(std::span<const std::byte> bytes, const std::string& name);

}  // namespace hairbake
