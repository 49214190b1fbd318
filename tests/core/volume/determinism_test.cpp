// The same bytes for any number of threads, and nearly the same on any SIMD target.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/parallel.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

/// A ball of wavy strands, 18,000 vertices, dense in the middle.
StrandGeometry wavy_ball() {
    Random random(31);
    StrandModel model;
    for (int s = 0; s < 600; ++s) {
        std::vector<Vec3d> points{random_point_in_ball(random, 1)};
        Vec3d direction = random_direction(random);
        for (int k = 0; k < 29; ++k) {
            direction = normalized(direction + random_direction(random) * 0.3);
            points.push_back(points.back() + direction * 0.04);
        }
        model.add(points, 0.008, random.next(0.3, 1));
    }
    return model.geometry();
}

TEST(Determinism, GivesTheSameBitsForAnyNumberOfThreads) {
    const StrandGeometry strands = wavy_ball();
    for (const DirectionSet set : {DirectionSet::fibonacci, DirectionSet::random}) {
        TransmittanceSettings settings = with_voxels(64);
        settings.direction_set = set;
        std::vector<float> one;
        with_threads(1, [&] { one = bake(strands, settings); });
        for (const int threads : {2, 7}) with_threads(threads, [&] { EXPECT_EQ(bake(strands, settings), one); });
    }
}

/// Lets Highway choose among `targets` only, as long as the object lives.
class OnlyTargets {
public:
    explicit OnlyTargets(std::int64_t targets) {
        hwy::SetSupportedTargetsForTest(targets);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    }
    ~OnlyTargets() {
        hwy::SetSupportedTargetsForTest(0);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    }
};

TEST(Determinism, AgreesBetweenSimdTargetsTo1e5) {
    // HWY_TARGETS of this file are the targets that core/volume is compiled for: here AVX3, AVX2, SSE4, SSSE3 and the
    // scalar path.
    const StrandGeometry strands = wavy_ball();
    std::int64_t scalar = HWY_STATIC_TARGET;
    std::vector<float> expected;
    {
        const OnlyTargets only(scalar);
        expected = bake(strands, with_voxels(64));
    }
    int compared = 0;
    for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0; targets &= targets - 1) {
        const std::int64_t target = targets & -targets;
        const OnlyTargets only(target);
        const auto a = bake(strands, with_voxels(64));
        double worst = 0;
        for (std::size_t v = 0; v < a.size(); ++v)
            worst = std::max(worst, std::abs(double(a[v]) - double(expected[v])));
        EXPECT_LE(worst, 1e-5) << hwy::TargetName(target);
        ++compared;
    }
    EXPECT_GE(compared, 1);
}

TEST(Determinism, OfTheScalarPathDoesNotDependOnThreads) {
    const StrandGeometry strands = wavy_ball();
    const OnlyTargets only(HWY_STATIC_TARGET);
    std::vector<float> one;
    with_threads(1, [&] { one = bake(strands, with_voxels(40, 20)); });
    with_threads(7, [&] { EXPECT_EQ(bake(strands, with_voxels(40, 20)), one); });
}

}  // namespace
}  // namespace hairbake
