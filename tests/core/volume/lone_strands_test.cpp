// Strands alone or in pairs, where the truth is known and the mean field is at its weakest.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

struct Worst {
    double error = 0, mean = 0;
    std::size_t count = 0;
    void see(double value, double expected) {
        error = std::max(error, std::abs(value - expected));
        mean += value - expected;
        ++count;
    }
};

TEST(Transmittance, OfALoneStraightStrandIsOne) {
    for (const double ratio : {0.02, 0.035, 0.05}) {
        Random random(1);
        Worst worst;
        for (int k = 0; k < 60; ++k) {
            const Vec3d d = random_direction(random), p = random_point_in_ball(random, 0.1);
            StrandModel model;
            model.add(straight(p - d, p + d, 1 + k % 40), 1);
            model.add_box(Vec3d(-1.2), Vec3d(1.2));
            const StrandGeometry g = model.geometry([](const Vec3d& q) { return q; }, ratio / 32);
            const auto a = bake(g, with_voxel_size(1.0 / 32));
            for (std::size_t v = 0; v + 2 < a.size(); ++v) worst.see(a[v], 1);
        }
        std::printf("w/h %.3f: worst %.5f mean %.5f\n", ratio, worst.error, worst.mean / worst.count);
    }
}

}  // namespace
}  // namespace hairbake
