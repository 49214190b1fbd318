#include "core/mesh/mesh_file.h"

#include <tiny_obj_loader.h>

#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

#include "core/base/error.h"

namespace hairbake {

TriangleMesh read_mesh(std::span<const std::byte> bytes, const std::string& name) {
    tinyobj::ObjReader reader;
    if (!reader.ParseFromString(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), ""))
        throw Error(ErrorKind::bad_input, name + " is not an OBJ file: " + reader.Error());
    TriangleMesh mesh;
    const auto& positions = reader.GetAttrib().vertices;
    for (std::size_t i = 0; i + 2 < positions.size(); i += 3)
        mesh.positions.push_back({positions[i], positions[i + 1], positions[i + 2]});
    for (const tinyobj::shape_t& shape : reader.GetShapes())
        for (std::size_t i = 0; i + 2 < shape.mesh.indices.size(); i += 3) {
            const auto corner = [&](std::size_t c) {
                return static_cast<std::uint32_t>(shape.mesh.indices[i + c].vertex_index);
            };
            mesh.triangles.push_back({corner(0), corner(1), corner(2)});
        }
    return mesh;
}

TriangleMesh read_mesh(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(ErrorKind::bad_input, file.string() + ": " + std::generic_category().message(errno));
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    return read_mesh(std::as_bytes(std::span(text)), file.string());
}

}  // namespace hairbake
