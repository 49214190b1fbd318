// Reads mesh files of every known format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace hairbake {

/// A mesh with what was found in its file.
struct MeshFile {
    TriangleMesh mesh;
    std::string format;  ///< as people write it: "OBJ", "PLY, ASCII"
    std::uint64_t faces = 0;
    std::uint64_t concave_faces = 0, crossing_faces = 0;
    std::uint64_t turned_triangles = 0;  ///< by orient()
    std::vector<std::string> warnings;   ///< for the person who gave the file; each continues "the mesh: ..."
};

/// Reads a mesh file of at most 256 MiB (it needs up to 15 times that memory). Its first bytes decide the format,
/// whatever its name: "ply" is PLY, "glTF" a binary glTF file, JSON a glTF file, any other text OBJ. A UTF-8 byte order
/// mark is skipped. obj_reader.h, ply_reader.h and gltf_reader.h say what is taken of each. No other file is opened.
/// - Positions have the file's order, whether or not a face uses them. None is added.
/// - A polygon is cut into triangles by PolygonCutter (polygon_cut.h), which warns where an outline crosses itself.
///   Triangles that name a position twice are left out.
/// - Triangles are turned so that they agree about the outside (mesh_orientation.h), with a warning.
/// - The normal of a position is the file's where it is unambiguous; otherwise it is the mean of its triangles' normals
///   weighted by their angles, or (0, 1, 0) where no triangle gives one. A normal of the file that points to the back of
///   triangles that were turned is turned, too.
///
/// Throws Error(bad_input) naming the file and, as far as the format has them, line, element or face: a file of another
/// format, coordinates that are no numbers or beyond 1e18, faces of fewer than three corners or with an index that names
/// no position, a file without triangles.
/// Throws Error(out_of_resources) when memory ends.
MeshFile read_mesh_file(const std::filesystem::path& file);

/// The same from memory; `name` stands for the file in messages. The fuzzers call this one.
MeshFile read_mesh_file(std::span<const std::byte> bytes, const std::string& name);

/// The mesh alone, for callers that have no use for the rest.
TriangleMesh read_mesh(const std::filesystem::path& file);
TriangleMesh read_mesh(std::span<const std::byte> bytes, const std::string& name);

/// Makes those checks of read_mesh() that need no more than the beginning of the file: it is there, can be opened, is a
/// regular file and not too long, and has the header of a known format.
/// Throws the same errors with the same words.
void check_mesh(const std::filesystem::path& file);

/// Whether the file begins as PLY or binary glTF, has the extension of a mesh, or is a text with a line that begins with
/// "v ". In the last two cases read_mesh() may refuse it.
/// Throws Error(bad_input) when the file cannot be opened.
bool is_mesh_file(const std::filesystem::path& file);

}  // namespace hairbake
