#include "core/mesh/mesh_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/base/error.h"
#include "core/mesh/mesh_normals.h"
#include "core/sample/head_mesh.h"
#include "tests/support/mesh_bytes.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TriangleMesh triangles(const std::string& text) { return mesh_of(text).mesh; }

TEST(MeshFile, ReadsPositionsInOrderWhetherUsedOrNotAndEveryGroup) {
    const TriangleMesh mesh =
        triangles("# a\nmtllib /etc/passwd\no a\nv 9 9 9\n" + square + "g b\nf 2 3 4\nusemtl c\nf 2 4 5\n");
    ASSERT_EQ(mesh.positions.size(), 5u);
    EXPECT_EQ(mesh.positions[0], Vec3f(9, 9, 9));
    EXPECT_EQ(mesh.positions[2], Vec3f(1, 0, 0));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{1, 2, 3}, {1, 3, 4}}));
    EXPECT_EQ(mesh.normals[0], Vec3f(0, 1, 0));  // in no triangle
    EXPECT_EQ(mesh.normals[2], Vec3f(0, 0, 1));  // counter-clockwise seen from +z
}

TEST(MeshFile, ReadsEveryFormOfCornersNumbersAndLineEnds) {
    const std::vector<Triangle> expected{{0, 1, 2}};
    for (const char* face : {"f 1 2 3", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/7/1 2/8/1 3/9/1", "f -4 -3 -2",
                             "f\t1   2\t3  # end", "f 1 \\\n 2 \\\r\n3", "f 1/ 2/ 3/"})
        EXPECT_EQ(triangles(square + "vn 0 0 1\n" + face).triangles, expected) << face;
    const TriangleMesh mesh = triangles("v +1e-3 -.5 2.\rv 0 0 0 1\r\nv 1 2 3 0.5 0.5 0.5\n\nf 1 2 3\r\n");
    EXPECT_EQ(mesh.positions[0], Vec3f(1e-3f, -0.5f, 2));
    EXPECT_EQ(mesh.positions[2], Vec3f(1, 2, 3));
    EXPECT_EQ(mesh.triangles, expected);
}

TEST(MeshFile, CutsPolygonsOfHundredsOfCornersIntoFans) {
    std::string text, face = "f";
    for (int k = 0; k < 500; ++k) {
        text += "v " + std::to_string(std::cos(k * 0.0125)) + " " + std::to_string(std::sin(k * 0.0125)) + " 0\n";
        face += ' ';
        face += std::to_string(k + 1);
    }
    const TriangleMesh mesh = triangles(text + face);
    ASSERT_EQ(mesh.triangles.size(), 498u);
    EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
    EXPECT_EQ(mesh.triangles[497], (Triangle{0, 498, 499}));
}

TEST(MeshFile, LeavesOutTrianglesThatNameAPositionTwice) {
    EXPECT_EQ(triangles(square + "f 1 1 2 3\nf 4 4 4\n").triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(MeshFile, TakesTheFilesNormalsWhereEveryCornerAgrees) {
    // Position 1 has one normal in both faces (two indices, one value), 2 two, 3 none in the second face, 4 only a
    // zero.
    const TriangleMesh mesh = triangles(
        square + "vn 3 0 0\nvn 0 5 0\nvn 3 0 0\nvn 0 0 0\nf 1//1 2//1 3//1\nf 1//3 3 4//4\nf 1//1 2//2 4//4\n");
    EXPECT_EQ(mesh.normals[0], Vec3f(1, 0, 0));
    for (const std::size_t i : {1, 2, 3}) EXPECT_EQ(mesh.normals[i], Vec3f(0, 0, 1)) << i;
}

TEST(MeshFile, NormalsOfFacesAreWeightedByTheirAngles) {
    // A cube's corner: three squares at right angles, each cut into triangles at will: (1, 1, 1) / sqrt 3 whatever the
    // cuts, which weights by area would miss.
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {-1, -1, 0}, {-1, 0, -1}, {0, -1, -1}, {9, 9, 9}};
    mesh.triangles = {{0, 1, 4}, {0, 4, 2}, {0, 3, 5}, {0, 5, 1}, {0, 2, 6}, {0, 6, 3}};
    const Vec3f normal = normals_of_faces(mesh)[0];
    for (const int axis : {0, 1, 2}) EXPECT_NEAR(normal[axis], 0.57735, 1e-5);
    EXPECT_EQ(normals_of_faces(mesh)[7], Vec3f(0, 1, 0));
}

TEST(MeshFile, RefusesWhatIsNoMeshAndSaysWhereAndWhy) {
    const auto expect = [](const std::string& text, const std::vector<std::string>& parts) {
        for (const std::string& part : parts)
            EXPECT_NE(mesh_refusal(text).find(part), std::string::npos) << mesh_refusal(text);
    };
    expect("", {"head.obj", "no triangle"});
    expect(square, {"line 5", "no triangle"});
    expect(square + "f 1 1 2", {"no triangle"});
    for (const char* number : {"nan", "inf", "-inf", "1e400", "2e18", "abc", "1,5", "0x10", "1e2147483649", "--1"})
        expect(std::string("v 0 0 0\nv 0 ") + number + " 0\n", {"line 2", number, "-1e18 to 1e18"});
    expect("v 0 0\n", {"line 1", "fewer than three"});
    expect("v 0 0\\\n\n", {"line 2", "fewer than three"});
    for (const char* index : {"0", "5", "-5", "4294967297", "99999999999999999999", "1.5", "x", "-", ""})
        if (*index) expect(square + "f 1 2 " + index, {"line 5", index, "1 to 4"});
    expect(square + "vn 0 0 1\nf 1//2 2//1 3//1", {"line 6", "no normal", "1 to 1"});
    expect(square + "f 1 2", {"line 5", "2 corners", "three"});
    expect(square + "f", {"line 5", "0 corners"});
    EXPECT_LT(mesh_refusal("v " + std::string(100000, '1') + "x 0 0").size(), 300u);
}

// Relatives: the mark before PLY and JSON (their tests), UTF-16.
TEST(MeshFile, SkipsAByteOrderMarkAndNamesUtf16) {
    EXPECT_EQ(triangles("\xef\xbb\xbf" + square + "f 1 2 3\n").positions.size(), 4u);
    EXPECT_NE(mesh_refusal("\xff\xfev\0 \0").find("UTF-16"), std::string::npos);
}

// Relatives: all four forms of a corner that names a normal; normals that stand behind the faces.
TEST(MeshFile, FacesMayNameNormalsThatTheFileLacks) {
    for (const char* face : {"f 1//1 2//1 3//1", "f 1/1/1 2/2/2 3/3/3", "f -4//-1 -3//-1 -2//-1", "f 1//7 2 3"}) {
        EXPECT_EQ(triangles(square + face).triangles, (std::vector<Triangle>{{0, 1, 2}})) << face;
        EXPECT_EQ(triangles(square + face).normals[0], Vec3f(0, 0, 1)) << face;
        EXPECT_NE(mesh_warnings(square + face).find("1 faces name normals"), std::string::npos) << face;
    }
    const std::string late = square + "f 1//1 2//1 3//1\nvn 1 0 0\nf 1 3 4\n";
    EXPECT_EQ(triangles(late).normals[0], Vec3f(0, 0, 1));
    EXPECT_NE(mesh_warnings(late).find("none before them"), std::string::npos);
    EXPECT_EQ(mesh_warnings(square + "vn 0 0 1\nf 1//1 2//1 3//1\n"), "");
}

// The shape of ../shared/data/cases/concave_L0.obj, begun at each of its corners. Relative: turned round.
TEST(MeshFile, CutsAConcaveFaceToTheSameSurfaceWhereverItBegins) {
    const std::string corners = "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\n";
    for (int begin = 0; begin < 6; ++begin)
        for (const int step : {1, 5}) {
            std::string face = "f";
            for (int k = 0; k < 6; ++k) face += " " + std::to_string((begin + step * k) % 6 + 1);
            const MeshFile file = mesh_of(corners + face);
            EXPECT_EQ(file.concave_faces, 1u);
            ASSERT_EQ(file.mesh.triangles.size(), 4u);
            double area = 0;
            for (const auto& t : file.mesh.triangles) {
                const Vec3f a = file.mesh.positions[t[0]], b = file.mesh.positions[t[1]], c = file.mesh.positions[t[2]];
                const Vec3f across = cross(b - a, c - a);
                EXPECT_EQ(across.z > 0, step == 1);
                area += length(across) / 2;
                const Vec3f middle = (a + b + c) / 3.0f;
                EXPECT_FALSE(middle.x > 1 && middle.y > 1);  // outside the L
            }
            EXPECT_NEAR(area, 5, 1e-5);
        }
}

// Relatives: triangles that disagree, a mesh that is inside out, a mesh without a fault.
TEST(MeshFile, CountsTheFacesAndTrianglesThatItChangesInWarnings) {
    EXPECT_NE(mesh_warnings(square + "f 1 2 3\nf 1 3 2 4\nf 1 2 3 4\n")
                  .find("in 1 of its 3 faces the outline crosses "
                        "itself, first in face 2"),
              std::string::npos);
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    EXPECT_EQ(mesh_warnings(corners + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"), "");
    EXPECT_NE(mesh_warnings(corners + "f 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n").find("1 of its 4 triangles disagree"),
              std::string::npos);
    EXPECT_NE(mesh_warnings(corners + "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n").find("run clockwise seen from outside"),
              std::string::npos);
    // A normal of the file on the back of a turned triangle is turned, too.
    const std::string normals = "vn -1 -1 -1\nvn 1 0 0\nvn 0 1 0\nvn 0 0 1\n";
    const MeshFile outward =
        mesh_of(corners + normals + "f 1//1 3//3 2//2\nf 1//1 2//2 4//4\nf 2//2 3//3 4//4\nf 3//3 1//1 4//4\n");
    std::string inward = corners + "vn 1 1 1\nvn -1 0 0\nvn 0 -1 0\nvn 0 0 -1\n";
    const MeshFile turned =
        mesh_of(inward + "f 1//1 2//2 3//3\nf 1//1 4//4 2//2\nf 2//2 4//4 3//3\nf 3//3 4//4 1//1\n");
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(turned.mesh.normals[i], outward.mesh.normals[i]) << i;
}

TEST(MeshFile, RefusesOtherFormatsByName) {
    for (const auto& [bytes, name] : {std::pair("Kaydara FBX Binary  ", "FBX"),
                                      {"PXR-USDC", "USD"},
                                      {"#usda 1.0", "USD"},
                                      {"Ogawa", "Alembic"},
                                      {"BLENDER-v300", "Blender"},
                                      {"solid ball\n", "STL"},
                                      {"<?xml version", "Collada"},
                                      {"HAIR", "groom"},
                                      {"OFF\n", "OFF"}}) {
        EXPECT_NE(mesh_refusal(bytes).find(name), std::string::npos) << mesh_refusal(bytes);
        EXPECT_NE(mesh_refusal(bytes).find("PLY (\"ply\")"), std::string::npos) << mesh_refusal(bytes);
    }
    EXPECT_NE(mesh_refusal(std::string("\1\2\0\4", 4)).find("01 02 00 04"), std::string::npos);
}

TEST(MeshFile, SurvivesBytesThatAreNoText) {
    std::string noise;
    for (int k = 0; k < 4096; ++k) noise += static_cast<char>(k * 167 % 256);
    mesh_refusal(noise);
    EXPECT_EQ(mesh_refusal(square + noise + "\nf 1 2 3\n").find("was read"),
              std::string::npos);  // it holds a zero byte
    noise.erase(std::remove(noise.begin(), noise.end(), '\0'), noise.end());
    EXPECT_EQ(triangles(square + noise + "\nf 1 2 3\n").triangles.size(), 1u);
}

TEST(MeshFile, ReadsTheSampleHeadBack) {
    const test_support::TemporaryFolder folder;
    const TriangleMesh head = make_head_mesh(12);
    write_obj(head, folder / "head.obj");
    const TriangleMesh mesh = read_mesh(folder / "head.obj");
    EXPECT_EQ(mesh.triangles, head.triangles);
    ASSERT_EQ(mesh.positions.size(), head.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        EXPECT_LT(length(mesh.positions[i] - head.positions[i]), 1e-5f);  // seven digits of at most 20
        EXPECT_LT(length(mesh.normals[i] - head.normals[i]), 1e-6f);
    }
}

TEST(MeshFile, NamesAFileThatIsNotThereOrTooLarge) {
    const test_support::TemporaryFolder folder;
    EXPECT_THROW(read_mesh(folder / "none.obj"), Error);
    EXPECT_THROW(read_mesh(folder / "."), Error);
    std::ofstream(folder / "large.obj") << "v";
    std::filesystem::resize_file(folder / "large.obj", std::uintmax_t{300} << 20);  // a hole: takes no disk
    try {
        read_mesh(folder / "large.obj");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("large.obj has 314572800 bytes"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace hairbake
