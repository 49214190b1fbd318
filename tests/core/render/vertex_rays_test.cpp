#include "core/reference/vertex_rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "core/reference/tracer.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

TEST(VertexRays, SeesWhatThePacketsOfTheTracerSee) {
    // The same rules and the same origin and direction: equal but for a ray that grazes a strand, where Embree's
    // single rays and packets may round differently.
    // With a mesh too: half a ball, so that vertices lie on it, inside, outside and beyond its open side.
    TriangleMesh bowl;
    for (int k = 0; k < 24; ++k) {
        const double angle = k * std::numbers::pi / 12;
        bowl.positions.push_back(Vec3f(Vec3d(0.6 * std::cos(angle), 0, 0.6 * std::sin(angle))));
    }
    bowl.positions.push_back({0, -0.6f, 0});
    for (const Vec3f& p : bowl.positions) bowl.normals.push_back(normalized(p));
    for (std::uint32_t k = 0; k < 24; ++k) bowl.triangles.push_back({k, (k + 1) % 24, 24});
    for (const auto& [opacity, occluder] : {std::pair{1.0, false}, {0.4, false}, {1.0, true}, {0.4, true}}) {
        Random random(5);
        StrandModel model;
        for (int s = 0; s < 60; ++s) {
            std::vector<Vec3d> points{random_point_in_ball(random, 1)};
            for (int k = 0; k < 4; ++k) points.push_back(points.back() + random_direction(random) * 0.3);
            model.add(points, 0.08, opacity);
        }
        const StrandGeometry strands = model.geometry();
        Progress progress;
        const StrandScene scene(strands, progress, occluder ? &bowl : nullptr);
        const VertexRays rays(scene, progress);
        int differ = 0, hidden = 0;
        for (std::uint32_t v = 0; v < strands.vertex_count(); ++v) {
            const std::vector<std::uint32_t> vertex{v};
            for (int k = 0; k < 4; ++k) {
                const std::vector<Vec3d> direction{random_direction(random)};
                const float packet = trace_transmittance(scene, vertex, direction, progress)[0];
                differ += rays.transmittance(v, direction[0]) != packet;
                hidden += packet < 1;
            }
        }
        EXPECT_LE(differ, 1);
        EXPECT_GT(hidden, 100);  // of 1,200: the comparison has something to compare
    }
}

}  // namespace
}  // namespace hairbake
