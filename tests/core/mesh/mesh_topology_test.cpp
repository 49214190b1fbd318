#include "core/mesh/mesh_topology.h"

#include <gtest/gtest.h>

#include "core/sample/head_mesh.h"
#include "tests/support/mesh_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

TEST(MeshTopology, ABallIsClosedAndTellsWhenItIsInsideOut) {
    const TriangleMesh ball = ball_mesh({3, 4, 5}, 2, 8);
    const MeshTopology topology = topology_of(ball);
    EXPECT_TRUE(topology.closed);
    EXPECT_FALSE(topology.inside_out);
    EXPECT_EQ(topology.edges, ball.triangles.size() * 3 / 2);  // each in two triangles
    EXPECT_TRUE(topology_of(turned_round(ball)).inside_out);
    EXPECT_TRUE(topology_of(make_head_mesh(16)).closed);
}

TEST(MeshTopology, AMissingTriangleOpensThreeEdges) {
    TriangleMesh ball = ball_mesh({0, 0, 0}, 1, 8);
    ball.triangles.pop_back();
    const MeshTopology topology = topology_of(ball);
    EXPECT_FALSE(topology.closed);
    EXPECT_EQ(topology.open_edges, 3u);
    EXPECT_EQ(topology.irregular_edges, 0u);
}

TEST(MeshTopology, ATriangleThatIsTurnedRoundOrThereTwiceMakesItsEdgesIrregular) {
    TriangleMesh ball = ball_mesh({0, 0, 0}, 1, 8);
    TriangleMesh turned = ball;
    std::swap(turned.triangles[5][0], turned.triangles[5][1]);
    EXPECT_EQ(topology_of(turned).irregular_edges, 3u);
    ball.triangles.push_back(ball.triangles[5]);
    EXPECT_EQ(topology_of(ball).irregular_edges, 3u);
    EXPECT_FALSE(topology_of(ball).closed);
}

TEST(MeshTopology, ASeamOfEqualPositionsDoesNotOpenAMesh) {
    TriangleMesh ball = ball_mesh({0, 0, 0}, 1, 8), split;
    for (const auto& t : ball.triangles) {
        const auto first = static_cast<std::uint32_t>(split.positions.size());
        for (const std::uint32_t i : t) split.positions.push_back(ball.positions[i]);
        split.triangles.push_back({first, first + 1, first + 2});
    }
    EXPECT_TRUE(topology_of(split).closed);
    EXPECT_EQ(topology_of(split).edges, topology_of(ball).edges);
}

TEST(MeshTopology, ADiscIsOpenAndNothingIsNotClosed) {
    EXPECT_EQ(topology_of(disc_mesh(0, 1, 10)).open_edges, 10u);
    EXPECT_FALSE(topology_of({}).closed);
}

}  // namespace
}  // namespace hairbake
