// Whole pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/fiber/kajiya_kay.h"
#include "core/render/pixel_samples.h"
#include "core/render/renderer.h"
#include "tests/support/kajiya_kay.h"
#include "tests/support/make_map.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;
using std::numbers::pi;

/// What a picture needs, for a model whose tangents are those of its segments.
struct Studio {
    explicit Studio(StrandGeometry geometry, const EnvironmentMap& sky, double exponent = 64)
        : strands(std::move(geometry)),
          scene(strands, progress),
          hits(scene, nullptr),
          fiber(testing::kajiya_kay_model(exponent)),
          lights(make_light_set(sky, 64, progress), *fiber) {
        for (std::size_t v = 0; v < strands.vertex_count(); ++v) {
            const std::size_t from = strands.segments[v] == Segment::none ? v - 1 : v;
            tangents.push_back(normalized(strands.positions[from + 1] - strands.positions[from]));
        }
    }

    std::vector<Vec3f> render(const FiberLighting& lighting, const Camera& camera, const FrameSettings& frame,
                              const EnvironmentMap* background = nullptr) {
        const RenderScene shown{.hits = hits,
                                .tangents = tangents,
                                .strands = strands,
                                .lighting = lighting,
                                .lobes = fiber->lobes(),
                                .kd = kd,
                                .ks = ks,
                                .mesh_lights = nullptr,
                                .mesh_albedo = {},
                                .background = background};
        return render_frame(shown, camera, frame, progress);
    }

    Progress progress;
    StrandGeometry strands;
    StrandScene scene;
    FirstHits hits;
    std::unique_ptr<const FiberModel> fiber;
    LightSum lights;
    std::vector<Vec3f> tangents;
    Vec3d kd{0.02, 0.05, 0.08}, ks{0.3, 0.2, 0.1};
    VertexTransmittance open;
};

/// Sixty curly strands in a ball.
StrandModel thicket() {
    Random random(5);
    StrandModel model;
    for (int s = 0; s < 60; ++s) {
        std::vector<Vec3d> points{random_point_in_ball(random, 1)};
        for (int k = 0; k < 5; ++k) points.push_back(points.back() + test_support::random_direction(random) * 0.3);
        model.add(points, 0.05);
    }
    return model;
}

FrameSettings frame_of(int size, int samples) { return {size, size, samples, 1, Channel::beauty}; }

TEST(Picture, OfHairUnderAWhiteSkyIsKdPiSquaredPlusKsSOfThePixelsAngle) {
    // One fat straight strand along x covers the whole view; T = 1. D = pi^2; S(theta') of a constant sky is lambda_0 =
    // 2 pi int k dx (specular_zonal, an independent quadrature), with theta' of each pixel's own ray. Exact sums: the
    // map's 2.8-degree texels integrate the p = 64 lobe (half-width 8.4 degrees) to 1e-3. The maps: linear between 33
    // angles, error (pi / 32)^2 / 8 |S''| <= 1.2e-3 * |S''/S|, with S ~ sin(theta') near its ends' 1 %: 1 % of S.
    StrandModel model;
    model.add(straight({-40, 0, 0}, {40, 0, 0}, 8), 8);
    const EnvironmentMap white = testing::make_map(128, [](const Vec3d&) { return Vec3d(1); });
    Studio studio(model.geometry(), white);
    IrradianceSettings settings;
    const IrradianceMaps maps = bake_irradiance(white, settings, {}, studio.progress);
    const Camera camera = look_at({0, 0, 10}, {6, 0, 4}, {0, 1, 0}, 20);
    const FrameSettings frame = frame_of(24, 1);
    const auto brute = studio.render(*brute_lighting(studio.open, studio.lights), camera, frame);
    const auto reference = studio.render(
        *reference_lighting(VertexRays(studio.scene, studio.progress), studio.open, studio.lights, 2), camera, frame);
    const auto baked = studio.render(*baked_lighting(studio.open, maps), camera, frame);
    double lowest = 10, highest = -1;
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 24; ++x) {
            const std::size_t i = std::size_t(y) * 24 + x;
            const PixelPoint point = PixelSamples(1, i, 1).point(0);
            const Vec3d direction = camera.direction(2 * (x + point.x) / 24 - 1, 1 - 2 * (y + point.y) / 24, 1);
            const double theta = std::acos(-direction.x);
            lowest = std::min(lowest, theta);
            highest = std::max(highest, theta);
            const double s = specular_zonal(1, 64, theta)[0];
            for (int c = 0; c < 3; ++c) {
                const double expected = studio.kd[c] * pi * pi + studio.ks[c] * s;
                EXPECT_NEAR(brute[i][c], expected, 1e-3 * expected);
                EXPECT_NEAR(reference[i][c], expected, 1e-3 * expected);
                EXPECT_NEAR(baked[i][c], expected, 0.01 * expected);
            }
        }
    EXPECT_LT(lowest, 130 * pi / 180);  // the angle does change over the picture
    EXPECT_GT(highest, 140 * pi / 180);
}

TEST(Picture, OfATurnedSceneUnderATurnedSkyIsTheSame) {
    // Rounding of turned positions (1e-7 of the extent, 2e-6 of a width) moves silhouettes and shadows by that much: a
    // sample in 1e5 may meet another strand or be hidden. Compared are pixels, which are equal to 1e-3 but for those.
    const std::array<double, 3> turn_deg{20, 50, -35};
    const Matrix3 matrix = rotation_matrix(turn_deg);
    const auto turn = [&](const Vec3d& p) { return transform(matrix, p); };
    const EnvironmentMap sky = testing::noise_map(64, 7);
    EnvironmentMap turned_sky = sky;
    turned_sky.rotation = matrix;
    const StrandModel model = thicket();
    Studio plain(model.geometry(), sky), turned(model.geometry(turn), turned_sky);
    const Vec3d eye{0.5, 1, 6}, up{0, 1, 0};
    const Camera camera = look_at(eye, {}, up, 25), turned_camera = look_at(turn(eye), {}, turn(up), 25);
    const FrameSettings frame = frame_of(48, 4);
    const auto compare = [](const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
        std::size_t differ = 0;
        for (std::size_t i = 0; i < a.size(); ++i) differ += length(a[i] - b[i]) > 1e-3f * length(a[i]);
        return differ;
    };
    const auto brute = plain.render(*brute_lighting(plain.open, plain.lights), camera, frame, &sky);
    EXPECT_LE(
        compare(brute, turned.render(*brute_lighting(turned.open, turned.lights), turned_camera, frame, &turned_sky)),
        5u);
    const auto traced = plain.render(
        *reference_lighting(VertexRays(plain.scene, plain.progress), plain.open, plain.lights, 8), camera, frame, &sky);
    EXPECT_LE(compare(traced, turned.render(*reference_lighting(VertexRays(turned.scene, turned.progress), turned.open,
                                                                turned.lights, 8),
                                            turned_camera, frame, &turned_sky)),
              12u);
    EXPECT_GT(compare(brute, traced), 200u);  // the strands do shadow each other
    EXPECT_GT(compare(brute, plain.render(*brute_lighting(plain.open, plain.lights), turned_camera, frame, &sky)),
              500u);
}

TEST(Picture, IsTheSameToTheLastBitForAnyNumberOfThreadsAndAnotherForAnotherSeed) {
    const EnvironmentMap sky = testing::noise_map(64, 7);
    Studio studio(thicket().geometry(), sky);
    const Camera camera = look_at({0, 0, 6}, {}, {0, 1, 0}, 25);
    const auto lighting = reference_lighting(VertexRays(studio.scene, studio.progress), studio.open, studio.lights, 4);
    FrameSettings frame{37, 29, 3, 1, Channel::beauty};  // tiles that are cut off at the edges
    std::vector<Vec3f> one;
    with_threads(1, [&] { one = studio.render(*lighting, camera, frame, &sky); });
    for (const int threads : {2, 5})
        with_threads(threads, [&] { EXPECT_TRUE(studio.render(*lighting, camera, frame, &sky) == one) << threads; });
    frame.seed = 2;
    EXPECT_FALSE(studio.render(*lighting, camera, frame, &sky) == one);
}

/// One for every point; counts them.
class CountingLighting : public FiberLighting {
public:
    void light(std::span<const StrandPoint> points, std::span<FiberLight> result, const Progress&) const override {
        for (FiberLight& light : result) light = {1, {Vec3d(1)}};
        most = std::max(most, points.size());
        all += points.size();
    }
    mutable std::size_t most = 0, all = 0;
};

TEST(Picture, OfManySamplesHoldsFewPointsAtATime) {
    // A strand so thick that it fills the picture: each of the 64 pixels has 1,024 points, 65,536 in all; lit are at
    // most 16,384 and what one pixel adds. The picture is Kd whatever was lit together.
    StrandModel model;
    model.add({{0, -50, 0}, {0, 50, 0}}, 20);
    Studio studio(model.geometry(), testing::make_map(32, [](const Vec3d&) { return Vec3d(1); }));
    const CountingLighting lighting;
    std::vector<Vec3f> pixels;
    with_threads(1, [&] {
        pixels = studio.render(lighting, look_at({0, 0, 40}, {}, {0, 1, 0}, 10), frame_of(8, 1024));
    });
    EXPECT_EQ(lighting.all, 65536u);
    EXPECT_LE(lighting.most, 16384u + 1024);
    for (const Vec3f& pixel : pixels) EXPECT_LT(length(Vec3d(pixel) - studio.kd), 1e-7);
}

TEST(Picture, ConvergesToTheSameWhateverTheSeed) {
    // Two independent pictures of n samples differ by sqrt(2) sigma / sqrt(n) or less (stratified); 16 times the
    // samples, a quarter of the difference at most, with a margin for what is random: a third.
    const EnvironmentMap sky = testing::noise_map(64, 7);
    Studio studio(thicket().geometry(), sky);
    const Camera camera = look_at({0, 0, 6}, {}, {0, 1, 0}, 25);
    const auto lighting = brute_lighting(studio.open, studio.lights);
    const auto difference = [&](int samples) {
        const auto a = studio.render(*lighting, camera, {20, 20, samples, 1, Channel::beauty});
        const auto b = studio.render(*lighting, camera, {20, 20, samples, 2, Channel::beauty});
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(length(a[i] - b[i]), 2);
        return std::sqrt(sum);
    };
    EXPECT_LT(difference(64), difference(4) / 3);
}

TEST(Picture, BackgroundIsTheSkyInThePixelsDirection) {
    // A sky that shows each direction as a colour: (d + 1) / 2, in texels of 0.7 degrees: 0.012 / 2 at most.
    const EnvironmentMap sky = testing::make_map(512, [](const Vec3d& d) { return (d + Vec3d(1)) * 0.5; });
    StrandModel model;
    model.add({{0, -90, 0}, {0, -91, 0}}, 0.1);  // out of sight
    Studio studio(model.geometry(), sky);
    const Camera camera = look_at({0, 0, 0}, {1, 0.3, -2}, {0, 1, 0}, 60);
    const auto picture = studio.render(*brute_lighting(studio.open, studio.lights), camera, frame_of(16, 1), &sky);
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const PixelPoint p = PixelSamples(1, i, 1).point(0);
        const Vec3d d = camera.direction(2 * (double(i % 16) + p.x) / 16 - 1, 1 - 2 * (double(i / 16) + p.y) / 16, 1);
        EXPECT_LT(length(Vec3d(picture[i]) - (d + Vec3d(1)) * 0.5), 0.007);
    }
}

TEST(Channels, AreThePartsOfTheBeautyTransmittanceAndTangent) {
    const EnvironmentMap sky = testing::noise_map(64, 7);
    StrandModel model;
    model.add(straight({-40, 0, 0}, {40, 0, 0}, 8), 8);
    Studio studio(model.geometry(), sky);
    const std::vector<float> a(studio.strands.vertex_count(), 0.25f);
    const VertexTransmittance quarter{a};
    const auto lighting = brute_lighting(quarter, studio.lights);
    const Camera camera = look_at({0, 0, 10}, {3, 0, 4}, {0, 1, 0}, 20);
    FrameSettings frame = frame_of(8, 2);
    const auto beauty = studio.render(*lighting, camera, frame);
    const auto channel = [&](Channel which) {
        frame.channel = which;
        return studio.render(*lighting, camera, frame);
    };
    const auto diffuse = channel(Channel::diffuse), specular = channel(Channel::specular);
    const auto transmittance = channel(Channel::transmittance), tangent = channel(Channel::tangent);
    for (std::size_t i = 0; i < beauty.size(); ++i) {
        EXPECT_LT(length(beauty[i] - diffuse[i] - specular[i]), 1e-6f * length(beauty[i]));
        EXPECT_EQ(transmittance[i], Vec3f(0.25f));
        EXPECT_EQ(tangent[i], Vec3f(1, 0, 0));
    }
}

TEST(Picture, StopsWhenItIsCancelled) {
    const EnvironmentMap sky = testing::noise_map(64, 7);
    Studio studio(thicket().geometry(), sky);
    const auto lighting = brute_lighting(studio.open, studio.lights);
    studio.progress.cancel();
    EXPECT_THROW(studio.render(*lighting, look_at({0, 0, 6}, {}, {0, 1, 0}, 25), frame_of(64, 4)), Error);
}

}  // namespace
}  // namespace hairbake
