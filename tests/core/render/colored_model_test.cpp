// Render modes of a fibre model with azimuth, colored lobes and no maps: what such a model needs of them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/render/fiber_lighting.h"
#include "tests/support/make_map.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;
using std::numbers::pi;

/// Three lobes: grey, colored, and colored with a dependence on root and tip.
class Colored : public FiberModel {
public:
    std::span<const FiberLobe> lobes() const override {
        static constexpr FiberLobe lobes[] = {{"grey", LobeRole::diffuse, false},
                                              {"colored", LobeRole::specular, true},
                                              {"tilted", LobeRole::specular, true}};
        return lobes;
    }
    bool is_zonal() const override { return false; }
    bool is_symmetric_root_tip() const override { return false; }
    double sharpness() const override { return 1; }

    static Vec3d kernel(int lobe, const Vec3d& l, const FiberView& view) {
        const double half = 0.5 * (1 + dot(l, view.to_eye)), along = 0.5 * (1 + dot(l, view.tangent));
        if (lobe == 0) return Vec3d(half);
        if (lobe == 1) return {half, half * half, half * half * half};
        return {along, 0.5 * along, along * along};
    }

    void evaluate(const LightDirections& lights, const FiberView& view, KernelBlock& kernels) const override {
        for (std::size_t i = 0; i < light_block; ++i)
            for (int lobe = 0; lobe < 3; ++lobe) {
                const Vec3d k = kernel(lobe, {lights.x[i], lights.y[i], lights.z[i]}, view);
                for (int channel = 0; channel < (lobe == 0 ? 1 : 3); ++channel)
                    kernels.values[lobe][channel][i] = float(k[channel]);
            }
    }
};

std::vector<StrandPoint> points_on(const std::vector<StrandPlace>& places) {
    Random random(3);
    std::vector<StrandPoint> points;
    for (const StrandPlace& place : places)
        points.push_back(
            {place, {testing::random_direction(random), testing::random_direction(random)}, random.next_u64()});
    return points;
}

std::vector<FiberLight> lit(const FiberLighting& lighting, const std::vector<StrandPoint>& points) {
    std::vector<FiberLight> result(points.size());
    lighting.light(points, result, Progress());
    return result;
}

LobeSums direct_sum(const LightSet& set, const FiberView& view, double transmittance) {
    LobeSums sums{};
    for (std::size_t k = 0; k < set.size(); ++k) {
        const Vec3d flux(set.flux[4 * k], set.flux[4 * k + 1], set.flux[4 * k + 2]);
        for (int lobe = 0; lobe < 3; ++lobe)
            sums[lobe] += flux * Colored::kernel(lobe, {set.x[k], set.y[k], set.z[k]}, view) * transmittance;
    }
    return sums;
}

void expect_equal(const LobeSums& found, const LobeSums& expected, double tolerance) {
    for (std::size_t lobe = 0; lobe < 3; ++lobe)
        EXPECT_LT(length(found[lobe] - expected[lobe]), tolerance * length(expected[lobe])) << lobe;
    EXPECT_EQ(found[3], Vec3d());
}

TEST(ColoredModel, BruteForceAndAConstantDirectionalTransmittanceAreTheSumsOfEachLobe) {
    const LightSet set = make_light_set(testing::noise_map(64, 7), 16, Progress());
    const Colored model;
    const LightSum lights(set, model);
    const auto points = points_on({{0, 0.5}, {0, 0.1}, {0, 0.9}});
    const std::vector<float> a(2, 0.3f), sh(2, float(2 * std::sqrt(pi) * 0.3));  // c_0 of a constant: A sqrt(4 pi)
    const auto brute = lit(*brute_lighting(VertexTransmittance{a}, lights), points);
    const DirectionalTransmittance transmittance{a, sh, 1, {}};
    const auto directional = lit(*directional_lighting(transmittance, lights), points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const LobeSums expected = direct_sum(set, points[i].view, double(0.3f));
        expect_equal(brute[i].lobes, expected, 1e-5);
        expect_equal(directional[i].lobes, expected, 2e-5);
        EXPECT_NEAR(directional[i].transmittance, 0.3, 1e-5);
    }
}

TEST(ColoredModel, TheReferenceEstimatesEachLobeWithoutBias) {
    // A lone straight strand does not shadow itself: T = 1. The guess of one half makes the estimate depend on the
    // drawn lights' colors: color times 1/2 over its energy, of magnitude at most 1/2 of the sum; 40,000 draws: sigma
    // <= 0.5 / 200 of the sum; allowed are 4 sigma.
    StrandModel strand;
    strand.add(straight({-1, 0, 0}, {1, 0, 0}, 4), 0.01);
    const StrandGeometry strands = strand.geometry();
    Progress progress;
    const StrandScene scene(strands, progress);
    const LightSet set = make_light_set(testing::noise_map(64, 7), 6, Progress());
    const Colored model;
    const LightSum lights(set, model);
    const std::vector<float> half(strands.vertex_count(), 0.5f);
    const VertexTransmittance guess{half};
    const auto points = points_on({{0, 0.25}, {1, 0.5}, {2, 0.75}});
    const auto found = lit(*reference_lighting(VertexRays(scene, progress), guess, lights, 40000), points);
    for (std::size_t i = 0; i < points.size(); ++i)
        expect_equal(found[i].lobes, direct_sum(set, points[i].view, 1), 4 * 0.5 / 200);
}

}  // namespace
}  // namespace hairbake
