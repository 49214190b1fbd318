#include "core/reference/vertex_ray.h"

#include <gtest/gtest.h>

#include "core/reference/tracer.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

TEST(VertexRay, SeesWhatThePacketsOfTheTracerSee) {
    // The same rules and the same origin and direction: equal but for a ray that grazes a strand, where Embree's
    // single rays and packets may round differently.
    for (const double opacity : {1.0, 0.4}) {
        Random random(5);
        StrandModel model;
        for (int s = 0; s < 60; ++s) {
            std::vector<Vec3d> points{random_point_in_ball(random, 1)};
            for (int k = 0; k < 4; ++k) points.push_back(points.back() + random_direction(random) * 0.3);
            model.add(points, 0.08, opacity);
        }
        const StrandGeometry strands = model.geometry();
        Progress progress;
        const StrandScene scene(strands, progress);
        VertexRay ray(scene);
        int differ = 0, hidden = 0;
        for (std::uint32_t v = 0; v < strands.vertex_count(); ++v) {
            const std::vector<std::uint32_t> vertex{v};
            for (int k = 0; k < 4; ++k) {
                const std::vector<Vec3d> direction{random_direction(random)};
                const float packet = trace_transmittance(scene, vertex, direction, progress)[0];
                differ += ray.transmittance(v, direction[0]) != packet;
                hidden += packet < 1;
            }
        }
        EXPECT_LE(differ, 1);
        EXPECT_GT(hidden, 100);  // of 1,200: the comparison has something to compare
    }
}

}  // namespace
}  // namespace hairbake
