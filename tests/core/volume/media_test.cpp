#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/analytic_media.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

TEST(Media, ProbeBall) {
    for (double sigma : {0.5, 1.0, 2.0, 4.0})
        for (int voxels : {32, 64}) {
            double mean[4]{}, sq[4]{};
            const int runs = 6;
            for (int run = 0; run < runs; ++run) {
                Random random(100 + run);
                StrandModel model;
                Fibres f;
                f.width = 0.004;
                f.length = 0.2;
                f.extinction = sigma;
                fill(model, ball(1), Vec3d(-1), Vec3d(1), f, random);
                std::vector<Vec3d> probes;
                const double radii[4] = {0.05, 0.5, 0.9, 0.999};
                for (int c = 0; c < 4; ++c)
                    for (int k = 0; k < 100; ++k) probes.push_back(random_direction(random) * radii[c]);
                const auto first = model.add_probes(probes);
                const auto a = bake(model.geometry(), with_voxels(voxels));
                for (int c = 0; c < 4; ++c) {
                    double m = 0;
                    for (int k = 0; k < 100; ++k) m += a[first + 100 * c + k] / 100.0;
                    m -= ball_transmittance(sigma, 1, radii[c]);
                    mean[c] += m / runs;
                    sq[c] += m * m / runs;
                }
                if (run == 0) std::printf("%zu vertices\n", model.vertex_count());
            }
            for (int c = 0; c < 4; ++c)
                std::printf("sigma %.1f vox %d class %d: bias %.4f se %.4f (A=%.3f)\n", sigma, voxels, c, mean[c],
                            std::sqrt((sq[c] - mean[c] * mean[c]) / (runs - 1)),
                            ball_transmittance(sigma, 1, c == 0 ? .05 : c == 1 ? .5 : c == 2 ? .9 : .999));
        }
}

}  // namespace
}  // namespace hairbake
