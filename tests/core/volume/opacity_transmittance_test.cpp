// The transmittance stage by deep opacity maps.
#include "core/volume/opacity_transmittance.h"
#include "core/visibility/direction_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/sample/groom_generator.h"
#include "tests/core/reference/trace.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

TransmittanceSettings with_maps(int layers, double spacing, int resolution, int directions = 100) {
    TransmittanceSettings settings;
    settings.directions = directions;
    settings.opacity_maps = {layers, spacing, resolution};
    return settings;
}

Transmittance bake_maps(const TransmittanceScene& scene, const TransmittanceSettings& settings) {
    Progress progress;
    return bake_transmittance_opacity_maps(scene, settings, progress);
}

StrandGeometry small_groom(std::size_t vertices = 6000) {
    GroomSettings settings;
    settings.style = GroomStyle::wavy;
    settings.vertices = vertices;
    StrandSettings strand;
    strand.width_scale = 8;  // as dark as a groom of many more strands
    return make_strand_geometry(generate_groom(settings), strand);
}

double rms(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(double(a[i]) - double(b[i]), 2);
    return std::sqrt(sum / double(a.size()));
}

double mean_of(const std::vector<float>& a) {
    double sum = 0;
    for (const float x : a) sum += x;
    return sum / double(a.size());
}

TEST(OpacityMaps, OfALoneStraightStrandAreOne) {
    // A vertex's own strand does not count in its texels, for any number of segments. Only rounding errors of a sum
    // remain.
    Random random(1);
    for (int k = 0; k < 30; ++k) {
        const Vec3d d = random_direction(random), p = random_point_in_ball(random, 0.1);
        StrandModel model;
        model.add(straight(p - d, p + d, 1 + 7 * k), 0.003);
        const std::size_t own = model.vertex_count();
        model.add_box(Vec3d(-1.2), Vec3d(1.2));  // the strand may shadow its two points
        const auto a = bake_maps({model.geometry()}, with_maps(3, 2, 128)).average;
        for (std::size_t v = 0; v < own; ++v) {
            EXPECT_NEAR(a[v], 1, 1e-5);
            EXPECT_LE(a[v], 1);
        }
    }
}

TEST(OpacityMaps, AreTheSameForAModelOfAnotherScale) {
    const StrandGeometry strands = small_groom();
    const auto a = bake_maps({strands}, with_maps(3, 2, 128, 25)).average;
    for (const float scale : {0.125f, 3.7f}) {
        StrandGeometry scaled = strands;
        for (Vec3f& p : scaled.positions) p *= scale;
        for (float& w : scaled.widths) w *= scale;
        const auto b = bake_maps({scaled}, with_maps(3, 2, 128, 25)).average;
        // A power of two changes no bit; otherwise points on texel edges may change sides.
        if (scale == 0.125f) {
            EXPECT_EQ(a, b);
        }
        EXPECT_LT(rms(a, b), 1e-4);
    }
}

TEST(OpacityMaps, HardlyChangeWhenTheModelIsTurned) {
    // Other directions through the model, other texels: the noise of 100 directions and of the texels, which falls with
    // their number. Measured 0.011 and, of the means, 0.0001; a wrong frame or a wrong sign makes 0.1 and more.
    const StrandGeometry strands = small_groom();
    const auto turn = rotation({1, 2, 3}, 1.1);
    StrandGeometry turned = strands;
    for (Vec3f& p : turned.positions) p = Vec3f(turn(Vec3d(p)));
    const auto a = bake_maps({strands}, with_maps(3, 2, 128)).average;
    const auto b = bake_maps({turned}, with_maps(3, 2, 128)).average;
    EXPECT_LT(rms(a, b), 0.02);
    EXPECT_NEAR(mean_of(a), mean_of(b), 0.003);
}

TEST(OpacityMaps, ComeCloserToTheTraceWithMoreLayers) {
    // Layers of one thickness, so that all of them grow thinner. The trace takes the same directions, so the
    // difference is the error of the maps: measured 0.19, 0.14, 0.11 and 0.09 (100 directions), where the volume method
    // has 0.08 (200 strands, each as wide as half a texel).
    const StrandGeometry strands = small_groom();
    const auto traced = trace(strands, all_vertices(strands), make_directions(DirectionSet::fibonacci, 36, 1));
    double last = 1;
    for (const int layers : {1, 3, 8, 16}) {
        const double error = rms(bake_maps({strands}, with_maps(layers, 1, 256, 36)).average, traced);
        EXPECT_LT(error, 0.92 * last) << layers;
        last = error;
    }
}

TEST(OpacityMaps, GiveTheSameBitsForAnyNumberOfThreads) {
    const StrandGeometry strands = small_groom();
    TransmittanceSettings settings = with_maps(3, 2, 128, 30);
    settings.sh_bands = 2;
    settings.bent_cone = true;
    Transmittance one;
    with_threads(1, [&] { one = bake_maps({strands}, settings); });
    for (const int threads : {2, 7})
        with_threads(threads, [&] {
            const Transmittance many = bake_maps({strands}, settings);
            EXPECT_EQ(many.average, one.average);
            EXPECT_EQ(many.sh, one.sh);
            EXPECT_EQ(many.bent_cone, one.bent_cone);
        });
}

TEST(OpacityMaps, GiveHarmonicsWhoseFirstIsTheAverage) {
    // c_0 = 2 sqrt(pi) A by definition.
    const StrandGeometry strands = small_groom(3000);
    TransmittanceSettings settings = with_maps(3, 2, 128, 50);
    settings.sh_bands = 3;
    settings.bent_cone = true;
    const Transmittance result = bake_maps({strands}, settings);
    ASSERT_EQ(result.sh.size(), 9 * strands.vertex_count());
    ASSERT_EQ(result.bent_cone.size(), 4 * strands.vertex_count());
    for (std::size_t v = 0; v < strands.vertex_count(); ++v)
        EXPECT_NEAR(result.sh[9 * v], 2 * std::sqrt(std::numbers::pi) * double(result.average[v]), 1e-5);
}

TEST(OpacityMaps, ShadowAReceiverBelowTheHairAndNotOneAboveIt) {
    // The one direction of a set of one is +x. A mat of 8,001 strands across it lets half of the light through in the
    // mean field; a texel holds 31 of them, or one more or less: 0.5^(1 +- 1/31) = 0.5 +- 0.011. Not shadowed: a
    // point between light and mat, one far beside it, and one that faces away, above whose plane no direction lies.
    StrandModel model;
    const double spacing = 0.0005;
    for (int i = -4000; i <= 4000; ++i)
        model.add({{0, i * spacing, -2}, {0, i * spacing, 2}}, spacing * std::numbers::ln2);
    TriangleMesh mesh;
    mesh.positions = {{-0.5f, 0, 0.1f}, {0.5f, 0, 0}, {-1, 1e9f, 1e30f}, {-0.5f, 0, 0}};
    mesh.normals = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}};
    const auto found = bake_maps({model.geometry(), nullptr, &mesh, false}, with_maps(3, 2, 256, 1)).receiver;
    ASSERT_EQ(found.size(), 8u);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(found[i], 0.5, 0.012) << i;
    for (std::size_t i = 2; i < 8; ++i) EXPECT_EQ(found[i], 1) << i;
}

TEST(OpacityMaps, TakeModelsOfNoneOneAndCoincidingPoints) {
    EXPECT_TRUE(bake_maps({StrandModel().geometry()}, with_maps(3, 2, 64)).average.empty());
    StrandModel point, stack;
    point.add({{1, 2, 3}}, 0.01);
    for (int k = 0; k < 3; ++k) stack.add({{1, 2, 3}, {1, 2, 3}}, 0.01);
    EXPECT_EQ(bake_maps({point.geometry()}, with_maps(3, 2, 64)).average, std::vector<float>(1, 1));
    EXPECT_EQ(bake_maps({stack.geometry()}, with_maps(3, 2, 64)).average, std::vector<float>(6, 1));
}

TEST(OpacityMaps, WarnWhenTheWidthsBoundTheTexels) {
    const StrandGeometry strands = small_groom(300);
    const auto fine = bake_maps({strands}, with_maps(3, 2, 4096, 1)),
               coarse = bake_maps({strands}, with_maps(3, 2, 16, 1));
    ASSERT_EQ(fine.warnings.size(), 1u);
    EXPECT_NE(fine.warnings[0].find("95th percentile"), std::string::npos);
    EXPECT_TRUE(coarse.warnings.empty());
}

TEST(OpacityMaps, RefuseAnOccluderAndSettingsOutOfRange) {
    const StrandGeometry strands = small_groom(300);
    const auto field_of = [&](const TransmittanceScene& scene, const TransmittanceSettings& settings) -> std::string {
        try {
            bake_maps(scene, settings);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            return error.field();
        }
        return "was baked";
    };
    const TriangleMesh mesh;
    EXPECT_EQ(field_of({strands, &mesh}, with_maps(3, 2, 64)), "occluder");
    EXPECT_EQ(field_of({strands}, with_maps(0, 2, 64)), "transmittance.opacity_maps.layers");
    EXPECT_EQ(field_of({strands}, with_maps(3, 0.5, 64)), "transmittance.opacity_maps.layer_spacing");
    EXPECT_EQ(field_of({strands}, with_maps(3, 2, 5000)), "transmittance.opacity_maps.resolution");
}

TEST(OpacityMaps, StopWhenAsked) {
    class StopAtOnce : public Progress {
    public:
        void report(double) override { cancel(); }
    } progress;
    const StrandGeometry strands = small_groom(300);
    try {
        bake_transmittance_opacity_maps({strands}, with_maps(3, 2, 64), progress);
        FAIL() << "ran to its end";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::cancelled);
    }
}

}  // namespace
}  // namespace hairbake
