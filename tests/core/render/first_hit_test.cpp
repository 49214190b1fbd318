#include "core/render/first_hit.h"

#include <gtest/gtest.h>

#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

/// A square of side 4 at height z, its normals straight up.
TriangleMesh square(float z) {
    TriangleMesh mesh;
    mesh.positions = {{-2, -2, z}, {2, -2, z}, {2, 2, z}, {-2, 2, z}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

TEST(FirstHit, IsTheNearestStrandWithThePlaceAlongIt) {
    StrandModel model;
    model.add({{-1, 0, 0}, {0, 0, 0}, {3, 0, 0}}, 0.2);
    const auto nearer = model.add({{-1, 0, 2}, {3, 0, 2}}, 0.2);
    const StrandGeometry strands = model.geometry();
    Progress progress;
    const StrandScene scene(strands, progress);
    const FirstHits hits(scene, nullptr);
    const FirstHit from_above = hits.find({1, 0, 9}, {0, 0, -1});
    ASSERT_EQ(from_above.kind, FirstHit::Kind::strand);
    EXPECT_EQ(from_above.strand.vertex, nearer);
    EXPECT_NEAR(from_above.strand.u, 0.5, 1e-5);  // x = 1 is half way from -1 to 3
    const FirstHit from_below = hits.find({2, 0.05, -9}, {0, 0, 1});
    ASSERT_EQ(from_below.kind, FirstHit::Kind::strand);
    EXPECT_EQ(from_below.strand.vertex, 1u);
    EXPECT_NEAR(from_below.strand.u, 2.0 / 3, 1e-5);
    EXPECT_EQ(hits.find({2, 0.11, -9}, {0, 0, 1}).kind, FirstHit::Kind::nothing);  // beyond the radius of 0.1
    EXPECT_EQ(hits.find({2, 0.09, -9}, {0, 0, 1}).kind, FirstHit::Kind::strand);
}

TEST(FirstHit, OfAMeshHidesStrandsBehindItAndNotBeforeIt) {
    StrandModel model;
    model.add({{-1, 0, 0}, {1, 0, 0}}, 0.2);
    const StrandGeometry strands = model.geometry();
    Progress progress;
    const StrandScene scene(strands, progress);
    const TriangleMesh mesh = square(1);
    const FirstHits hits(scene, &mesh);
    const FirstHit above = hits.find({0.5, 0, 9}, {0, 0, -1});
    ASSERT_EQ(above.kind, FirstHit::Kind::mesh);
    EXPECT_NEAR(above.normal.z, 1, 1e-6);
    EXPECT_EQ(hits.find({0.5, 0, -9}, {0, 0, 1}).kind, FirstHit::Kind::strand);
    EXPECT_EQ(hits.find({5, 0, 9}, {0, 0, -1}).kind, FirstHit::Kind::nothing);
}

}  // namespace
}  // namespace hairbake
