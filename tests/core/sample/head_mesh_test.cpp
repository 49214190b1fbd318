#include "core/sample/head_mesh.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "core/base/error.h"
#include "core/sample/head_shape.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using hairbake::test_support::TemporaryFolder;

TEST(HeadMesh, IsClosedAndOriented) {
    for (const int rings : {4, 17, 96}) {
        const TriangleMesh mesh = make_head_mesh(rings);
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;  // directed
        for (const auto& t : mesh.triangles)
            for (int corner = 0; corner < 3; ++corner) ++edges[{t[corner], t[(corner + 1) % 3]}];
        for (const auto& [edge, count] : edges) {
            ASSERT_EQ(count, 1);
            ASSERT_TRUE(edges.contains({edge.second, edge.first}));
        }
        // Euler: V - E + F = 2 for a sphere; each edge has two directions.
        const auto v = static_cast<long>(mesh.positions.size()), e = static_cast<long>(edges.size()) / 2;
        EXPECT_EQ(v - e + static_cast<long>(mesh.triangles.size()), 2);
    }
}

TEST(HeadMesh, HasTheVolumeOfTheShape) {
    const int rings = 96;
    const TriangleMesh mesh = make_head_mesh(rings);
    double volume = 0;
    for (const auto& t : mesh.triangles)
        volume += dot(Vec3d(mesh.positions[t[0]]), cross(Vec3d(mesh.positions[t[1]]), Vec3d(mesh.positions[t[2]]))) / 6;
    // Star-shaped about the origin: V = integral of r^3 / 3 over directions, here by the midpoint rule.
    double expected = 0;
    const int rows = 400, columns = 800;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const double y = 1 - (2 * row + 1.0) / rows, phi = 2 * std::numbers::pi * column / columns;
            const double across = std::sqrt(1 - y * y);
            const double r = head_radius({across * std::sin(phi), y, across * std::cos(phi)});
            expected += r * r * r / 3 * 4 * std::numbers::pi / (rows * columns);
        }
    // A sphere cut into steps of d = pi / rings loses about d^2 / 2 of its volume to the chords; the head's parts are
    // curved up to about twice as much: d^2 = 1.07e-3.
    EXPECT_GT(volume, 0);
    EXPECT_NEAR(volume / expected, 1, 1.1e-3);
    // A head: an ellipsoid of 7.6 x 9.2 x 9.4 alone has 2,753 cm3, a ball of 11 cm 5,575.
    EXPECT_GT(volume, 2700);
    EXPECT_LT(volume, 5600);
}

TEST(HeadMesh, HasUnitNormalsThatAgreeWithItsFacets) {
    const TriangleMesh mesh = make_head_mesh();
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const Vec3f& n : mesh.normals) ASSERT_NEAR(length(n), 1, 3e-7);  // rounding to floats: 3 * 2^-24 at most
    double agreement = 0, area = 0;
    for (const auto& t : mesh.triangles) {
        const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
        const Vec3d facet = cross(b - a, c - a);
        for (const std::uint32_t i : t) {
            ASSERT_GT(dot(Vec3d(mesh.normals[i]), facet), 0);
            agreement += dot(Vec3d(mesh.normals[i]), facet);
            area += length(facet);
        }
    }
    // Facets of 2 degrees on a smooth shape: the cosine is 1 but for tight creases.
    EXPECT_GT(agreement / area, 0.99);
}

TEST(HeadMesh, ItsShapeIsAHead) {
    EXPECT_NEAR(head_radius({0, 1, 0}), 9.2, 0.5);
    EXPECT_NEAR(head_radius({1, 0, 0}), 7.6, 0.5);
    EXPECT_NEAR(head_radius({0, 0, -1}), 9.9, 0.5);
    EXPECT_TRUE(is_scalp({0, 1, 0}));
    EXPECT_TRUE(is_scalp({0, 0, -1}));
    EXPECT_FALSE(is_scalp({0, 0, 1}));
    EXPECT_FALSE(is_scalp({0, -1, 0}));
}

TEST(HeadMesh, WritesAnObjFileThatReadsBack) {
    const TemporaryFolder folder;
    const TriangleMesh mesh = make_head_mesh(12);
    write_obj(mesh, folder / "head.obj");
    std::ifstream stream(folder / "head.obj");
    std::size_t positions = 0, normals = 0, faces = 0;
    for (std::string line; std::getline(stream, line);) {
        std::istringstream words(line);
        std::string key;
        words >> key;
        if (key == "v" || key == "vn") {
            Vec3d read;
            words >> read.x >> read.y >> read.z;
            const Vec3f expected = key == "v" ? mesh.positions.at(positions++) : mesh.normals.at(normals++);
            ASSERT_LE(length(read - Vec3d(expected)), 1e-5);  // seven digits of numbers below 20: 2e-6 at most an axis
        } else if (key == "f") {
            for (const std::uint32_t i : mesh.triangles.at(faces)) {
                std::string corner;
                words >> corner;
                ASSERT_EQ(corner, std::to_string(i + 1) + "//" + std::to_string(i + 1));
            }
            ++faces;
        }
    }
    EXPECT_EQ(positions, mesh.positions.size());
    EXPECT_EQ(normals, mesh.normals.size());
    EXPECT_EQ(faces, mesh.triangles.size());
}

TEST(HeadMesh, RefusesSizesOutOfRangeAndReportsAFullDisk) {
    EXPECT_THROW(make_head_mesh(3), Error);
    EXPECT_THROW(make_head_mesh(2049), Error);
    EXPECT_THROW(write_obj(make_head_mesh(4), "/dev/full"), Error);
}

}  // namespace
}  // namespace hairbake
