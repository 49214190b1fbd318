#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/support/mesh_bytes.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

/// A GLB file.
std::string glb(std::string json, std::string data) {
    while (json.size() % 4 != 0) json += ' ';
    while (data.size() % 4 != 0) data += '\0';
    std::string bytes = "glTF";
    const auto put = [&](std::uint32_t word) { bytes.append(reinterpret_cast<const char*>(&word), 4); };
    put(2);
    put(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + data.size()));
    put(static_cast<std::uint32_t>(json.size()));
    put(0x4E4F534A);
    bytes += json;
    put(static_cast<std::uint32_t>(data.size()));
    put(0x004E4942);
    return bytes + data;
}

/// Four corners of a square in the plane z = 0, their normals along z, and the indices of its two triangles.
std::string square_data() {
    std::string data;
    for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f,  // positions
                          0.f, 0.f, 2.f, 0.f, 0.f, 2.f, 0.f, 0.f, 2.f, 0.f, 0.f, 2.f})
        data.append(reinterpret_cast<const char*>(&x), 4);
    for (const std::uint16_t i : {0, 1, 2, 0, 2, 3}) data.append(reinterpret_cast<const char*>(&i), 2);
    return data;
}

const std::string triangles_primitive = R"({"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2})";
const std::string views = R"("buffers": [{"byteLength": 108}], "bufferViews": [{"buffer": 0, "byteLength": 48},
    {"buffer": 0, "byteOffset": 48, "byteLength": 48}, {"buffer": 0, "byteOffset": 96, "byteLength": 12}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
                  {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}])";

/// A scene with these nodes, of which node 0 is the root; `rest` adds members.
std::string scene(const std::string& nodes, const std::string& primitives = triangles_primitive,
                  const std::string& rest = "") {
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [)" + nodes +
           R"(], "meshes": [{"primitives": [)" + primitives + "]}]" + rest + ", " + views + "}";
}

std::string joined(const std::vector<std::string>& warnings) {
    std::string all;
    for (const std::string& warning : warnings) all += warning + "\n";
    return all;
}

TEST(GltfReader, ReadsABinaryFileAndJsonWithEmbeddedData) {
    const MeshFile file = mesh_of(glb(scene(R"({"mesh": 0})"), square_data()));
    EXPECT_EQ(file.format, "glTF, binary");
    EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(file.mesh.positions[2], Vec3f(1, 1, 0));
    EXPECT_EQ(file.mesh.normals[2], Vec3f(0, 0, 1));
    // The three floats 0 0 0, 1 0 0, 0 1 0 in base 64.
    const std::string json = R"( {"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}]})";
    for (const std::string& text : {json, "\xef\xbb\xbf" + json}) {
        const MeshFile plain = mesh_of(text);
        EXPECT_EQ(plain.format, "glTF, JSON");
        EXPECT_EQ(plain.mesh.positions[1], Vec3f(1, 0, 0));
        EXPECT_EQ(plain.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    }
}

// The root turns by 90 degrees about z (x to y) and moves by (10, 0, 0); the child is scaled by (2, 3, 4). So (1, 1, 0)
// becomes (2, 3, 0), then (-3, 2, 0), then (7, 2, 0). Relatives: a matrix, a mirror, two instances.
TEST(GltfReader, AppliesTheTransformsOfNodes) {
    const std::string turn = R"("rotation": [0, 0, 0.7071067811865476, 0.7071067811865476], "translation": [10, 0, 0])";
    const MeshFile nested =
        mesh_of(glb(scene("{" + turn + R"(, "children": [1]}, {"mesh": 0, "scale": [2, 3, 4]})"), square_data()));
    EXPECT_LT(length(nested.mesh.positions[2] - Vec3f(7, 2, 0)), 1e-5f);
    const MeshFile matrix = mesh_of(
        glb(scene(R"({"mesh": 0, "matrix": [0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 10, 0, 0, 1]})"), square_data()));
    EXPECT_LT(length(matrix.mesh.positions[2] - Vec3f(7, 2, 0)), 1e-5f);
    // Mirrored at x = 0, the square still faces +z, and so do its normals.
    const MeshFile mirrored = mesh_of(glb(scene(R"({"mesh": 0, "scale": [-1, 1, 1]})"), square_data()));
    EXPECT_EQ(mirrored.mesh.triangles, (std::vector<Triangle>{{0, 2, 1}, {0, 3, 2}}));
    EXPECT_EQ(mirrored.mesh.normals[1], Vec3f(0, 0, 1));
    const MeshFile twice = mesh_of(
        glb(scene(R"({"children": [1, 2]}, {"mesh": 0}, {"mesh": 0, "translation": [0, 0, 5]})"), square_data()));
    EXPECT_EQ(twice.mesh.positions.size(), 8u);
    EXPECT_EQ(twice.mesh.positions[4], Vec3f(0, 0, 5));
    EXPECT_EQ(twice.mesh.triangles.size(), 4u);
}

TEST(GltfReader, ReadsStripsFansAndSharedPositionsAndLeavesOutLines) {
    const auto with_mode = [](int mode) {
        return mesh_of(
            glb(scene(R"({"mesh": 0})", R"({"attributes": {"POSITION": 0}, "mode": )" + std::to_string(mode) + "}"),
                square_data()));
    };
    EXPECT_EQ(with_mode(5).mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
    EXPECT_EQ(with_mode(6).mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    const MeshFile mixed = mesh_of(glb(scene(R"({"mesh": 0})", triangles_primitive + ", " + triangles_primitive +
                                                                   R"(, {"attributes": {"POSITION": 0}, "mode": 1})"),
                                       square_data()));
    EXPECT_EQ(mixed.mesh.positions.size(), 4u);
    EXPECT_EQ(mixed.mesh.triangles.size(), 4u);
    EXPECT_NE(joined(mixed.warnings).find("1 of its primitives are points or lines"), std::string::npos);
}

TEST(GltfReader, SaysThatSkinsAndMorphTargetsAreNotApplied) {
    const MeshFile skinned = mesh_of(glb(scene(R"({"mesh": 0, "skin": 0, "translation": [9, 9, 9]})",
                                               triangles_primitive, R"(, "skins": [{"joints": [0]}])"),
                                         square_data()));
    EXPECT_EQ(skinned.mesh.positions[0], Vec3f(0, 0, 0));
    EXPECT_NE(joined(skinned.warnings).find("skin"), std::string::npos);
    const MeshFile morphed = mesh_of(
        glb(scene(R"({"mesh": 0})", R"({"attributes": {"POSITION": 0}, "indices": 2, "targets": [{"POSITION": 0}]})"),
            square_data()));
    EXPECT_NE(joined(morphed.warnings).find("morph"), std::string::npos);
}

TEST(GltfReader, RefusesWithTheReason) {
    const std::string node = R"({"mesh": 0})";
    const std::string good = scene(node);
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        text.replace(text.find(from), from.size(), to);
        return glb(text, square_data());
    };
    expect_mesh_refusal("glTF", {"4 bytes", "20"});
    expect_mesh_refusal(glb(good, square_data()).substr(0, 200), {"truncated"});
    expect_mesh_refusal("{\"asset\": ", {"cannot be parsed"});
    expect_mesh_refusal(replaced("\"2.0\"", "\"1.0\""), {"version", "1.0"});
    expect_mesh_refusal(replaced("\"indices\": 2", "\"indices\": 9"), {"cannot be parsed"});
    expect_mesh_refusal(replaced("\"POSITION\": 0", "\"POSITION\": 7"), {"accessor 7", "does not exist"});
    expect_mesh_refusal(replaced("\"count\": 4", "\"count\": 5"), {"accessor 0", "5 values", "108 bytes"});
    expect_mesh_refusal(replaced("\"count\": 4", "\"count\": 3"), {"4 normals", "3 positions"});
    expect_mesh_refusal(replaced("5126", "5125"), {"accessor 0", "neither floats"});
    expect_mesh_refusal(replaced("\"count\": 6, \"type\": \"SCALAR\"", "\"count\": 6, \"type\": \"VEC2\""),
                        {"accessor 2"});
    expect_mesh_refusal(replaced("\"nodes\": [0]", "\"nodes\": [3]"), {"node 3"});
    expect_mesh_refusal(glb(scene(R"({"children": [0]})"), square_data()), {"two parents"});
    expect_mesh_refusal(glb(scene(R"({"name": "empty"})"), square_data()), {"no triangle"});
    expect_mesh_refusal(
        glb(scene(node, triangles_primitive, R"(, "extensionsRequired": ["KHR_draco_mesh_compression"])"),
            square_data()),
        {"KHR_draco_mesh_compression", "without compression"});
    expect_mesh_refusal(R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4, "uri": "head.bin"}]})",
                        {"another file", "head.bin", ".glb"});
    std::string wrong_index = square_data();
    wrong_index[96] = 4;
    expect_mesh_refusal(glb(good, wrong_index), {"names position 4"});
    std::string infinite = square_data();
    infinite[2] = '\x80', infinite[3] = '\x7f';
    expect_mesh_refusal(glb(good, infinite), {"position 0", "inf"});
    std::string deep =
        R"({"asset": {"version": "2.0", "extras": )" + std::string(100000, '[') + std::string(100000, ']') + "}}";
    expect_mesh_refusal(deep, {"nested"});
}

}  // namespace
}  // namespace hairbake
