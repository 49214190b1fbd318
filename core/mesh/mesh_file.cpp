#include "core/mesh/mesh_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/mesh/gltf_reader.h"
#include "core/mesh/mesh_normals.h"
#include "core/mesh/mesh_orientation.h"
#include "core/mesh/mesh_reader.h"
#include "core/mesh/ply_reader.h"
#include "core/mesh/polygon_cut.h"

namespace hairbake {
namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{256} << 20;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

[[noreturn]] void refuse_size(const std::string& name, std::uintmax_t bytes) {
    throw Error(ErrorKind::bad_input, name + " has " + std::to_string(bytes) + " bytes; allowed are at most " +
                                          std::to_string(kMostBytes) + " for a mesh");
}

[[noreturn]] void refuse_unreadable(const std::filesystem::path& file, int error) {
    const int known = error != 0 ? error : EIO;
    throw Error(ErrorKind::bad_input, file.string() + ": " + std::generic_category().message(known), {}, known);
}

struct OpenMesh {
    std::ifstream stream;
    std::uintmax_t size;  ///< bytes
};

/// Opening comes after the look at the file: a named pipe without a writer would never be open.
OpenMesh open_mesh(const std::filesystem::path& file) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) refuse_unreadable(file, error.value());
    if (size > kMostBytes) refuse_size(file.string(), size);
    std::ifstream stream(file, std::ios::binary);
    if (!stream) refuse_unreadable(file, errno);
    return {std::move(stream), size};
}

std::span<const std::byte> without_mark(std::span<const std::byte> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return text.starts_with(kByteOrderMark) ? bytes.subspan(kByteOrderMark.size()) : bytes;
}

std::string faces_text(std::size_t count) { return std::to_string(count) + (count == 1 ? " face" : " faces"); }

/// Cuts the polygons of `from` into triangles of `file`. Returns the first face whose outline crosses itself.
std::size_t cut_faces(const PolygonMesh& from, MeshFile& file) {
    PolygonCutter cutter;
    std::size_t first_crossing = 0;
    file.faces = from.face_end.size();
    for (std::size_t i = 0; i < from.face_end.size(); ++i) {
        const PolygonKind kind = cutter.cut(file.mesh.positions, from.face(i), file.mesh.triangles);
        file.concave_faces += kind == PolygonKind::concave;
        if (kind == PolygonKind::crossing && ++file.crossing_faces == 1) first_crossing = i;
    }
    return first_crossing;
}

void warn_of_faces(std::size_t first_crossing, const MeshOrientation& orientation, MeshFile& file) {
    const std::size_t triangles = file.mesh.triangles.size();
    if (file.crossing_faces > 0)
        file.warnings.push_back("in " + std::to_string(file.crossing_faces) + " of its " + faces_text(file.faces) +
                                " the outline crosses itself, first in face " + std::to_string(first_crossing + 1) +
                                "; such a face becomes a fan of triangles about its corner with the smallest "
                                "coordinates");
    if (orientation.turned_triangles == triangles)
        file.warnings.push_back("its triangles run clockwise seen from outside: they are turned round");
    else if (orientation.turned_triangles > 0)
        file.warnings.push_back(std::to_string(orientation.turned_triangles) + " of its " + std::to_string(triangles) +
                                " triangles disagree with the others about the outside: they are turned round");
    if (orientation.unorientable_parts > 0)
        file.warnings.push_back(std::to_string(orientation.unorientable_parts) +
                                " of its connected parts can have no outside (as a Moebius band): left as in the file");
}

/// Takes the file's normals where it has them.
void take_normals(const PolygonMesh& from, const MeshOrientation& orientation, TriangleMesh& mesh) {
    if (from.normals.empty()) return;
    std::vector<bool> turned(mesh.positions.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (orientation.turned[t])
            for (const std::uint32_t i : mesh.triangles[t]) turned[i] = true;
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        const Vec3d normal(from.normals[i]);
        const double size = length(normal);
        if (!(size > 1e-30)) continue;
        const bool to_the_back = turned[i] && dot(normal, Vec3d(mesh.normals[i])) < 0;
        mesh.normals[i] = Vec3f(normal / (to_the_back ? -size : size));
    }
}

MeshFile triangles_of(PolygonFile from, const std::string& name) {
    MeshFile file;
    file.format = std::move(from.format);
    file.warnings = std::move(from.warnings);
    file.mesh.positions = std::move(from.mesh.positions);
    const std::size_t first_crossing = cut_faces(from.mesh, file);
    if (file.mesh.triangles.empty())
        refuse_mesh(name, "no triangle is left: each of its " + faces_text(file.faces) + " names a position twice");
    const MeshOrientation orientation = orient(file.mesh);
    file.turned_triangles = orientation.turned_triangles;
    warn_of_faces(first_crossing, orientation, file);
    file.mesh.normals = normals_of_faces(file.mesh);
    take_normals(from.mesh, orientation, file.mesh);
    return file;
}

/// At most the first mesh_header_bytes of the file.
std::vector<std::byte> beginning_of(OpenMesh& open) {
    std::vector<std::byte> bytes(std::min<std::uintmax_t>(open.size, mesh_header_bytes));
    open.stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(open.stream.gcount(), 0)));
    return bytes;
}

}  // namespace

void check_mesh(const std::filesystem::path& file) {
    OpenMesh open = open_mesh(file);
    const std::vector<std::byte> bytes = beginning_of(open);
    const auto first = without_mark(bytes);
    reader_of_mesh(first, file.string()).check(first, open.size - (bytes.size() - first.size()), file.string());
}

bool is_mesh_file(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) refuse_unreadable(file, errno);
    OpenMesh open{std::move(stream), mesh_header_bytes};
    const std::vector<std::byte> bytes = beginning_of(open);
    const auto first = without_mark(bytes);
    if (ply_reader.recognises(first) || glb_reader.recognises(first)) return true;
    std::string extension = file.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    constexpr std::string_view extensions[] = {".obj", ".ply", ".glb", ".gltf"};
    if (std::find(std::begin(extensions), std::end(extensions), extension) != std::end(extensions)) return true;
    const std::string_view text(reinterpret_cast<const char*>(first.data()), first.size());
    const bool is_text = std::none_of(text.begin(), text.end(), [](char c) { return c >= 0 && c < '\t'; });
    return is_text && (text.starts_with("v ") || text.find("\nv ") != std::string_view::npos);
}

MeshFile read_mesh_file(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.size() > kMostBytes) refuse_size(name, bytes.size());
    bytes = without_mark(bytes);
    const MeshReader& reader = reader_of_mesh(bytes.first(std::min(bytes.size(), mesh_header_bytes)), name);
    return triangles_of(reader.read(bytes, name), name);
}

MeshFile read_mesh_file(const std::filesystem::path& file) {
    auto [stream, size] = open_mesh(file);
    std::vector<std::byte> bytes(size);
    errno = 0;
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (stream.bad()) refuse_unreadable(file, errno);
    if (static_cast<std::uintmax_t>(stream.gcount()) != size)
        throw Error(ErrorKind::bad_input, file.string() + " ended after " + std::to_string(stream.gcount()) + " of " +
                                              std::to_string(size) + " bytes");
    return read_mesh_file(bytes, file.string());
}

TriangleMesh read_mesh(std::span<const std::byte> bytes, const std::string& name) {
    return read_mesh_file(bytes, name).mesh;
}

TriangleMesh read_mesh(const std::filesystem::path& file) { return read_mesh_file(file).mesh; }

}  // namespace hairbake
