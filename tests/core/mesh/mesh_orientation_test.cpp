#include "core/mesh/mesh_orientation.h"

#include <gtest/gtest.h>

#include <utility>

#include "core/base/random.h"
#include "core/mesh/mesh_topology.h"
#include "tests/support/mesh_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

/// Turns about `share` of the triangles.
TriangleMesh turned_at_random(TriangleMesh mesh, double share, std::uint64_t seed) {
    Random random(seed);
    for (auto& t : mesh.triangles)
        if (random.next(0, 1) < share) std::swap(t[0], t[1]);
    return mesh;
}

TriangleMesh both(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh mesh = a;
    const auto first = static_cast<std::uint32_t>(a.positions.size());
    mesh.positions.insert(mesh.positions.end(), b.positions.begin(), b.positions.end());
    for (const auto& t : b.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    return mesh;
}

/// Whether every triangle of [begin, end) faces away from `centre` (or towards it).
bool all_face(const TriangleMesh& mesh, std::size_t begin, std::size_t end, const Vec3d& centre, bool away) {
    for (std::size_t k = begin; k < end; ++k) {
        const auto& t = mesh.triangles[k];
        const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
        if ((dot(cross(b - a, c - a), a - centre) > 0) != away) return false;
    }
    return true;
}

// Relatives of the mesh turned at random: one triangle turned, most turned, all turned, a seam of doubled positions.
TEST(MeshOrientation, AClosedMeshIsTurnedOutwardWhateverWasTurned) {
    const TriangleMesh ball = ball_mesh({3, 4, 5}, 1, 12);
    for (const double share : {0.0, 0.01, 0.5, 0.9, 1.1}) {
        TriangleMesh mesh = turned_at_random(ball, share, 7);
        std::uint64_t wrong = 0;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) wrong += mesh.triangles[t] != ball.triangles[t];
        const MeshOrientation found = orient(mesh);
        EXPECT_EQ(found.turned_triangles, wrong) << share;
        EXPECT_TRUE(topology_of(mesh).closed);
        EXPECT_TRUE(all_face(mesh, 0, mesh.triangles.size(), {3, 4, 5}, true));
    }
    TriangleMesh split;
    for (const auto& t : turned_at_random(ball, 0.5, 8).triangles)
        for (const std::uint32_t i : t) split.positions.push_back(ball.positions[i]);
    for (std::uint32_t i = 0; i < split.positions.size(); i += 3) split.triangles.push_back({i, i + 1, i + 2});
    orient(split);
    EXPECT_TRUE(all_face(split, 0, split.triangles.size(), {3, 4, 5}, true));
}

TEST(MeshOrientation, EachClosedPartIsTurnedByItself) {
    const TriangleMesh ball = ball_mesh({0, 0, 0}, 1, 8), other = ball_mesh({5, 0, 0}, 1, 8);
    TriangleMesh mesh = both(ball, turned_round(other));
    EXPECT_EQ(orient(mesh).turned_triangles, other.triangles.size());
    EXPECT_TRUE(all_face(mesh, ball.triangles.size(), mesh.triangles.size(), {5, 0, 0}, true));
}

TEST(MeshOrientation, TheWallOfAHollowKeepsItsSideAndSoDoesAnEyeInAHead) {
    const TriangleMesh head = ball_mesh({0, 0, 0}, 2, 12), inner = ball_mesh({0.2, 0, 0}, 1, 8);
    TriangleMesh hollow = both(head, turned_round(inner)), eye = both(head, inner);
    EXPECT_EQ(orient(hollow).turned_triangles, 0u);
    EXPECT_EQ(orient(eye).turned_triangles, 0u);
    // Turned as a whole, the head is turned back. The inner ball's outside is then a hollow, which it may be.
    TriangleMesh inside_out = both(turned_round(head), inner);
    EXPECT_EQ(orient(inside_out).turned_triangles, head.triangles.size());
}

TEST(MeshOrientation, AnOpenPartThatAgreesStaysAndOneThatDoesNotFollowsTheLargerArea) {
    const TriangleMesh disc = disc_mesh(0, 1, 12);
    TriangleMesh mesh = turned_round(disc);
    EXPECT_EQ(orient(mesh).turned_triangles, 0u);
    for (const std::size_t count : {1, 3, 5}) {
        mesh = disc;
        for (std::size_t k = 0; k < count; ++k) std::swap(mesh.triangles[2 * k][1], mesh.triangles[2 * k][2]);
        EXPECT_EQ(orient(mesh).turned_triangles, count);
        EXPECT_EQ(mesh.triangles.size(), disc.triangles.size());
        EXPECT_TRUE(all_face(mesh, 0, mesh.triangles.size(), {0, -1, 0}, true));
    }
}

TEST(MeshOrientation, AMoebiusBandAndEdgesOfThreeTrianglesAreLeftAlone) {
    TriangleMesh band;  // five triangles that join into a band with half a twist
    for (int k = 0; k < 5; ++k) band.positions.emplace_back(float(k), float(k * k % 5), float(k * k * k % 7));
    band.triangles = {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 0, 4}, {4, 0, 1}};
    const auto before = band.triangles;
    const MeshOrientation found = orient(band);
    EXPECT_EQ(found.unorientable_parts, 1u);
    EXPECT_EQ(band.triangles, before);

    TriangleMesh fins;
    fins.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}};
    fins.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
    EXPECT_EQ(orient(fins).turned_triangles, 0u);
    TriangleMesh nothing;
    EXPECT_EQ(orient(nothing).turned_triangles, 0u);
}

}  // namespace
}  // namespace hairbake
