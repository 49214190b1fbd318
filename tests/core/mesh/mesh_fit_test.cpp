#include "core/mesh/mesh_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "tests/support/mesh_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

struct Hair {
    std::vector<Vec3f> positions;
    std::vector<std::uint32_t> begin{0};
    HairPoints points() const { return {positions, begin}; }
};

/// An egg, so that it is another shape when it is turned about x: the long axis along y, its middle at (0, 0.5, 0).
TriangleMesh egg() {
    TriangleMesh mesh = ball_mesh({0, 0, 0}, 1, 24);
    for (Vec3f& p : mesh.positions) p = {p.x, 1.6f * p.y + 0.5f, p.z};
    return mesh;
}

/// Strands that stand out of the upper half of the egg.
Hair hair_on_egg() {
    Hair hair;
    Random random(3);
    for (int s = 0; s < 300; ++s) {
        const double polar = random.next(0, std::numbers::pi / 2), azimuth = random.next(0, 2 * std::numbers::pi);
        const Vec3d d(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth));
        for (int k = 0; k < 5; ++k) hair.positions.emplace_back(Vec3d(d.x, 1.6 * d.y + 0.5, d.z) + d * (0.1 * k));
        hair.begin.push_back(static_cast<std::uint32_t>(hair.positions.size()));
    }
    return hair;
}

TriangleMesh scaled(TriangleMesh mesh, float scale) {
    for (Vec3f& p : mesh.positions) p = p * scale;
    return mesh;
}

std::string warnings_of(const TriangleMesh& mesh, const Hair& hair, bool closed = true) {
    std::string all;
    for (const std::string& warning : fit_of(mesh, closed, hair.points()).warnings) all += warning + "\n";
    return all;
}

TEST(MeshFit, AMeshOnWhichTheHairGrowsHasNoWarning) {
    const MeshFit fit = fit_of(egg(), true, hair_on_egg().points());
    EXPECT_TRUE(fit.warnings.empty());
    EXPECT_EQ(fit.looked_at, 1500u);
    EXPECT_EQ(fit.inside, 0u);
}

// Relatives: both directions of each usual factor.
TEST(MeshFit, NamesTheFactorOfAWrongUnit) {
    const Hair hair = hair_on_egg();
    for (const auto& [scale, text] : {std::pair(100.f, "100 times smaller"),
                                      {0.01f, "100 times larger"},
                                      {10.f, "10 times smaller"},
                                      {0.001f, "1000 times larger"},
                                      {2.54f, "2.54 times smaller"}}) {
        const std::string found = warnings_of(scaled(egg(), scale), hair);
        EXPECT_NE(found.find(text), std::string::npos) << scale << ": " << found;
        EXPECT_EQ(found.find("lie inside it") != std::string::npos, scale > 2) << found;
    }
}

// Relatives: either axis may be up; a wrong unit besides.
TEST(MeshFit, NamesTheTurnOfAWrongFrame) {
    const Hair hair = hair_on_egg();
    TriangleMesh z_up = egg(), other = egg();
    for (Vec3f& p : z_up.positions) p = {p.x, -p.z, p.y};
    for (Vec3f& p : other.positions) p = {p.x, p.z, -p.y};
    EXPECT_NE(warnings_of(z_up, hair).find("turned by -90 degrees about x (the mesh is z-up"), std::string::npos)
        << warnings_of(z_up, hair);
    EXPECT_NE(warnings_of(other, hair).find("turned by 90 degrees about x"), std::string::npos);
    EXPECT_NE(warnings_of(scaled(z_up, 100), hair).find("100 times smaller and turned by -90"), std::string::npos);
}

// A head that ends at the neck is open; its inside counts all the same.
TEST(MeshFit, CountsThePointsInsideAnOpenMesh) {
    TriangleMesh open = scaled(egg(), 100);
    open.triangles.resize(open.triangles.size() - 40);
    const MeshFit fit = fit_of(open, false, hair_on_egg().points());
    EXPECT_EQ(fit.looked_at, 1500u);
    EXPECT_EQ(fit.inside, 1500u);
    EXPECT_EQ(fit_of(disc_mesh(0.2, 5, 12), false, hair_on_egg().points()).inside, 0u);  // a shell has no inside
}

TEST(MeshFit, OtherMeshesAreJudgedBySizeAndDistanceAlone) {
    const Hair hair = hair_on_egg();
    EXPECT_EQ(warnings_of(disc_mesh(-3, 5, 12), hair, false), "");  // a floor
    TriangleMesh far = egg();
    for (Vec3f& p : far.positions) p.x += 90;
    EXPECT_NE(warnings_of(far, hair).find("times the hair's size away"), std::string::npos);
    EXPECT_NE(warnings_of(scaled(disc_mesh(-3, 5, 12), 70), hair, false).find("times larger than the hair"),
              std::string::npos);
    // Lashes on a head: it is far larger, and the roots are on it.
    Hair lashes;
    for (int s = 0; s < 20; ++s) {
        const double azimuth = 0.001 * s;
        for (int k = 0; k < 4; ++k)
            lashes.positions.emplace_back(
                Vec3d(std::cos(azimuth) * (1 + 0.004 * k), 0.5, std::sin(azimuth) * (1 + 0.004 * k)));
        lashes.begin.push_back(static_cast<std::uint32_t>(lashes.positions.size()));
    }
    EXPECT_EQ(warnings_of(egg(), lashes), "");
    EXPECT_EQ(warnings_of(egg(), Hair()), "");
}

}  // namespace
}  // namespace hairbake
