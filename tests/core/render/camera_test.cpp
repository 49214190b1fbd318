#include "core/render/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/error.h"
#include "core/render/pixel_samples.h"

namespace hairbake {
namespace {

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-12) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

/// Where a point appears: x and y in [-1, 1] when it is in the picture.
std::pair<double, double> project(const Camera& camera, const Vec3d& p, double aspect) {
    const Vec3d d = p - camera.eye;
    const double depth = -dot(d, camera.backward);
    return {dot(d, camera.right) / (depth * camera.tangent * aspect), dot(d, camera.up) / (depth * camera.tangent)};
}

TEST(OrbitCamera, LooksFromZAtAzimuth0AndFromXAt90AndDownFromYAtElevation90) {
    OrbitSettings orbit;
    orbit.target = Vec3d(1, 2, 3);
    orbit.distance = 5;
    expect_near(orbit_camera(orbit, {}, {}, 1).eye, {1, 2, 8});
    expect_near(orbit_camera(orbit, {}, {}, 1).up, {0, 1, 0});
    orbit.azimuth_deg = 90;
    expect_near(orbit_camera(orbit, {}, {}, 1).eye, {6, 2, 3});
    orbit.elevation_deg = 90;
    expect_near(orbit_camera(orbit, {}, {}, 1).eye, {1, 7, 3});
}

TEST(OrbitCamera, FramesTheBoundsTightly) {
    // All corners are inside, and the one that is furthest out is at 1 / margin = 1 / 1.04 of the half picture or, as
    // the margin moves the eye back, a little further in.
    const Vec3f low(-1, 2, -5), high(3, 9, 4);
    for (const double aspect : {0.5, 1.0, 2.5})
        for (const double azimuth : {0.0, 37.0, 200.0})
            for (const double elevation : {-80.0, 0.0, 30.0}) {
                const Camera camera =
                    orbit_camera({.target = {}, .distance = {}, .azimuth_deg = azimuth, .elevation_deg = elevation},
                                 low, high, aspect);
                double furthest = 0;
                for (int corner = 0; corner < 8; ++corner) {
                    const auto [x, y] = project(
                        camera, {corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z},
                        aspect);
                    furthest = std::max({furthest, std::abs(x), std::abs(y)});
                }
                EXPECT_LT(furthest, 1);
                EXPECT_GT(furthest, 0.95);
            }
}

TEST(LookAt, IsTheOrbitCameraForTheSameEye) {
    OrbitSettings orbit{
        .target = Vec3d(1, 2, 3), .distance = 7, .azimuth_deg = 20, .elevation_deg = -35, .fov_deg = 50};
    const Camera a = orbit_camera(orbit, {}, {}, 1), b = look_at(a.eye, *orbit.target, {0, 1, 0}, 50);
    expect_near(a.right, b.right);
    expect_near(a.up, b.up);
    expect_near(a.backward, b.backward);
    EXPECT_EQ(a.tangent, b.tangent);
    // The right edge of a square picture is half the field of view away from the axis.
    EXPECT_NEAR(dot(a.direction(1, 0, 1), -a.backward), std::cos(25 * std::numbers::pi / 180), 1e-12);
}

TEST(CameraSettings, OutOfRangeAreUsageErrors) {
    const auto refused = [](const auto& make) {
        try {
            make();
            return false;
        } catch (const Error& error) {
            return error.kind() == ErrorKind::usage;
        }
    };
    const double nan = std::nan("");
    EXPECT_TRUE(refused([] { look_at({1, 2, 3}, {1, 2, 3}, {0, 1, 0}, 30); }));
    EXPECT_TRUE(refused([] { look_at({0, 5, 0}, {0, 0, 0}, {0, 1, 0}, 30); }));
    EXPECT_TRUE(refused([] { look_at({0, 5, 0}, {0, 0, 0}, {0, 0, 0}, 30); }));
    EXPECT_TRUE(refused([&] { look_at({0, 5, nan}, {0, 0, 0}, {1, 0, 0}, 30); }));
    EXPECT_TRUE(refused([] { look_at({0, 5, 0}, {0, 0, 0}, {1, 0, 0}, 151); }));
    EXPECT_TRUE(refused([] { orbit_camera({.target = {}, .distance = -1.0}, {}, {}, 1); }));
    EXPECT_TRUE(refused([] { orbit_camera({.target = {}, .distance = {}, .elevation_deg = 91}, {}, {}, 1); }));
    EXPECT_TRUE(refused([&] { orbit_camera({.target = {}, .distance = {}, .azimuth_deg = nan}, {}, {}, 1); }));
}

TEST(PixelSamples, FillEveryColumnAndNearlyEveryRowForAnyCount) {
    // One point in each of n columns by construction. Rows: n multiples of the golden ratio leave no gap of the circle
    // wider than 1.171 / n times the golden ratio's next power, below 2 / n for all n (Swierczkowski's three distances;
    // the largest gap is phi^-k for Fibonacci numbers F_k+1 <= n < F_k+2, and n phi^-k < 1.9).
    for (const int n : {1, 2, 3, 5, 7, 16, 61, 256}) {
        const PixelSamples samples(3, 77, n);
        std::set<int> columns;
        std::vector<double> rows;
        for (int k = 0; k < n; ++k) {
            const PixelPoint p = samples.point(k);
            EXPECT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
            columns.insert(static_cast<int>(p.x * n));
            rows.push_back(p.y);
        }
        EXPECT_EQ(columns.size(), std::size_t(n));
        std::sort(rows.begin(), rows.end());
        double gap = rows.front() + 1 - rows.back();
        for (std::size_t k = 1; k < rows.size(); ++k) gap = std::max(gap, rows[k] - rows[k - 1]);
        EXPECT_LE(gap, 2.0 / n) << n;
    }
}

TEST(PixelSamples, DependOnSeedAndPixel) {
    const double here = PixelSamples(1, 5, 4).point(2).y;
    EXPECT_EQ(PixelSamples(1, 5, 4).point(2).y, here);
    EXPECT_NE(PixelSamples(2, 5, 4).point(2).y, here);
    EXPECT_NE(PixelSamples(1, 6, 4).point(2).y, here);
    // Uniform over pixels: the mean of 4,096 shifts is 1/2 within 4 / sqrt(12 * 4096) = 0.018.
    double mean = 0;
    for (std::uint64_t pixel = 0; pixel < 4096; ++pixel) mean += PixelSamples(1, pixel, 1).point(0).y / 4096;
    EXPECT_NEAR(mean, 0.5, 0.018);
}

}  // namespace
}  // namespace hairbake
