#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "tests/support/mesh_bytes.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

std::string ply_header(const std::string& format, const std::string& rest) {
    return "ply\nformat " + format + " 1.0\n" + rest + "end_header\n";
}
const std::string ply_square =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\n";
const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

/// The bytes of `value`, in the given order.
template <class T>
void put(std::string& out, T value, bool big) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof value);
    if (big) std::reverse(bytes, bytes + sizeof value);
    out.append(bytes, sizeof value);
}

TEST(PlyReader, ReadsTextWithEveryLineEndAndAByteOrderMark) {
    const std::string text =
        ply_header("ascii", "comment made by hand\nobj_info a\n" + ply_square) + points + "4 0 1 2 3\n";
    std::string crlf, cr = text;
    for (const char c : text) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    std::replace(cr.begin(), cr.end(), '\n', '\r');
    for (const std::string& bytes : {text, crlf, cr, "\xef\xbb\xbf" + text}) {
        const MeshFile file = mesh_of(bytes);
        EXPECT_EQ(file.format, "PLY, ASCII");
        EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
        EXPECT_EQ(file.mesh.positions[2], Vec3f(1, 1, 0));
        EXPECT_EQ(file.mesh.normals[0], Vec3f(0, 0, 1));
    }
}

// Relatives: all types of numbers, other elements and properties before, between and behind, normals.
TEST(PlyReader, ReadsBothByteOrdersAndSkipsWhatIsNotNeeded) {
    for (const bool big : {false, true}) {
        std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian",
                                       "element camera 1\nproperty double view\nproperty list ushort float extra\n"
                                       "element vertex 3\nproperty uchar red\nproperty double x\nproperty int16 y\n"
                                       "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                                       "element face 1\nproperty short flags\nproperty list uint8 uint32 vertex_index\n"
                                       "property char last\nelement edge 1\nproperty int a\n");
        put(bytes, 1.5, big);
        put<std::uint16_t>(bytes, 2, big);
        put(bytes, 1.0f, big);
        put(bytes, 2.0f, big);
        for (int i = 0; i < 3; ++i) {
            put<std::uint8_t>(bytes, 200, big);
            put(bytes, i == 1 ? 0.5 : 0.0, big);
            put<std::int16_t>(bytes, i == 2 ? -7 : 0, big);
            put(bytes, -1.25f, big);
            for (const float n : {0.0f, 0.0f, -2.0f}) put(bytes, n, big);
        }
        put<std::int16_t>(bytes, 9, big);
        put<std::uint8_t>(bytes, 3, big);
        for (const std::uint32_t i : {2u, 0u, 1u}) put(bytes, i, big);
        put<std::int8_t>(bytes, 1, big);
        put<std::int32_t>(bytes, 5, big);
        const MeshFile file = mesh_of(bytes);
        EXPECT_EQ(file.format, big ? "PLY, binary big-endian" : "PLY, binary little-endian");
        ASSERT_EQ(file.mesh.positions.size(), 3u);
        EXPECT_EQ(file.mesh.positions[1], Vec3f(0.5f, 0, -1.25f));
        EXPECT_EQ(file.mesh.positions[2], Vec3f(0, -7, -1.25f));
        EXPECT_EQ(file.mesh.triangles, (std::vector<Triangle>{{2, 0, 1}}));
        EXPECT_EQ(file.mesh.normals[0], Vec3f(0, 0, -1));  // the file's, of length 1
    }
}

TEST(PlyReader, ReadsFacesBeforeVerticesAndStrips) {
    const std::string vertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    EXPECT_EQ(mesh_of(ply_header("ascii", "element face 1\nproperty list uchar int vertex_indices\n" + vertices) +
                      "3 0 1 2\n" + points)
                  .mesh.triangles,
              (std::vector<Triangle>{{0, 1, 2}}));
    const MeshFile strips =
        mesh_of(ply_header("ascii", vertices + "element tristrips 1\nproperty list int int vertex_indices\n") + points +
                "7 0 1 3 -1 1 2 3\n");
    EXPECT_EQ(mesh_of(ply_header("ascii", vertices + "element tristrips 1\nproperty list int int vertex_indices\n") +
                      points + "4 0 1 3 2\n")
                  .mesh.triangles,
              strips.mesh.triangles);  // every second triangle of a strip runs the other way
    EXPECT_EQ(strips.mesh.triangles, (std::vector<Triangle>{{0, 1, 3}, {1, 2, 3}}));
}

TEST(PlyReader, RefusesWithThePlaceAndTheReason) {
    expect_mesh_refusal("ply\n", {"head.obj", "end_header"});
    expect_mesh_refusal(ply_header("ascii", ply_square).substr(0, 60), {"no end"});
    expect_mesh_refusal("ply\nformat binary 1.0\nend_header\n", {"line 2", "binary", "binary_big_endian"});
    expect_mesh_refusal("ply\nformat ascii 2.0\nend_header\n", {"line 2", "2.0", "1.0"});
    expect_mesh_refusal("ply\nelement vertex many\nend_header\n", {"line 2", "many"});
    expect_mesh_refusal("ply\nproperty float x\nend_header\n", {"line 2", "before the first element"});
    expect_mesh_refusal("ply\nelement vertex 1\nproperty half x\nend_header\n", {"line 3", "half", "float"});
    expect_mesh_refusal("ply\nsurprise\nend_header\n", {"line 2", "surprise"});
    expect_mesh_refusal(ply_header("ascii", "element vertex 4\nproperty float x\nproperty float y\n") + points,
                        {"x, y and z"});
    expect_mesh_refusal(ply_header("ascii", ply_square.substr(0, ply_square.find("element face"))) + points,
                        {"cloud of points"});
    expect_mesh_refusal(ply_header("ascii", ply_square) + points + "4 0 1 2 4\n", {"face 0", "vertex 4", "4 vertices"});
    expect_mesh_refusal(ply_header("ascii", ply_square) + points + "4 0 1 2 -1\n", {"line 14", "face 0", "-1"});
    expect_mesh_refusal(ply_header("ascii", ply_square) + points + "2 0 1\n", {"face 0", "2 corners"});
    expect_mesh_refusal(ply_header("ascii", ply_square) + "0 0 0\n1 0", {"truncated", "4 of element"});
    expect_mesh_refusal(ply_header("ascii", ply_square) + "0 0 0\n1 0 x\n" + points, {"line 11", "\"x\""});
    expect_mesh_refusal(ply_header("ascii", ply_square) + "0 0 nan\n" + points, {"vertex 0", "z is nan"});
    expect_mesh_refusal(ply_header("ascii", ply_square) + points + "9 0 1 2\n", {"face 0", "9 items"});
    // Counts that only a header claims take no memory.
    expect_mesh_refusal(ply_header("binary_little_endian",
                                   "element vertex 4000000000\nproperty float x\nproperty float y\n"
                                   "property float z\nelement face 1\n"
                                   "property list uchar int vertex_indices\n"),
                        {"truncated", "4000000000", "12 bytes each"});
}

}  // namespace
}  // namespace hairbake
