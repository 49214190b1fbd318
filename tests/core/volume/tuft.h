// A small groom for tests.
#pragma once

#include "tests/support/strand_models.h"

namespace hairbake::test_support {

/// A tuft: 400 strands of 25 points from the lower side of a ball, bending outwards. 10,000 vertices.
inline StrandModel tuft(double opacity = 1) {
    Random random(41);
    StrandModel model;
    for (int s = 0; s < 400; ++s) {
        std::vector<Vec3d> points{random_point_in_ball(random, 0.4)};
        Vec3d direction = normalized(Vec3d(0, 2, 0) + points[0] + random_direction(random) * 0.3);
        for (int k = 0; k < 24; ++k) {
            points.push_back(points.back() + direction * 0.05);
            direction =
                normalized(direction + random_direction(random) * 0.15 + Vec3d(points[0].x, -0.05, points[0].z) * 0.1);
        }
        model.add(points, 0.006, opacity);
    }
    return model;
}

}  // namespace hairbake::test_support
