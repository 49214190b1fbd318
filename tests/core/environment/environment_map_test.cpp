#include "core/environment/environment_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "core/environment/latlong.h"
#include "tests/support/make_map.h"

namespace hairbake {
namespace {

using testing::make_map;
using testing::random_direction;

Vec3d black(const Vec3d&) { return {}; }

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance) { EXPECT_LT(length(a - b), tolerance); }

TEST(LatLong, TexelSolidAnglesSumToTheSphere) {
    for (const int height : {1, 2, 31, 256, 2048}) {
        const LatLongRows rows = latlong_rows(2 * height, height);
        double sum = 0;
        for (const double angle : rows.solid_angle) sum += angle * 2 * height;
        EXPECT_NEAR(sum, 4 * std::numbers::pi, 1e-12) << height;
        // The definition, 2 pi / width (cos top - cos bottom), which cancels to about 1e-16.
        const double top = std::cos(0.0), bottom = std::cos(std::numbers::pi / height);
        EXPECT_NEAR(rows.solid_angle[0], std::numbers::pi / height * (top - bottom), 1e-15);
    }
}

TEST(LatLong, EachConventionLooksWhereItsNameSays) {
    // Direction of the centre column and of the column to its right (docs/math.md, section 1). All numbers are exact
    // but for cos(90 degrees) = 6e-17.
    struct Expected {
        LatLong convention;
        Vec3d centre, right;
    };
    for (const auto& [convention, centre, right] :
         {Expected{LatLong::gltf, {1, 0, 0}, {0, 0, 1}}, Expected{LatLong::filament, {0, 0, 1}, {1, 0, 0}},
          Expected{LatLong::openexr, {0, 0, 1}, {-1, 0, 0}}}) {
        const EnvironmentMap map = make_map(8, black, convention);
        expect_near(direction_of(map, {4, 2}), centre, 1e-15);
        expect_near(direction_of(map, {6, 2}), right, 1e-15);
        expect_near(direction_of(map, {2, 2}), -right, 1e-15);
        expect_near(direction_of(map, {0, 2}), -centre, 1e-15);
        expect_near(direction_of(map, {3, 0}), {0, 1, 0}, 1e-15);
        expect_near(direction_of(map, {3, 4}), {0, -1, 0}, 1e-15);
    }
}

TEST(LatLong, OnlyFilamentIsAMirrorImage) {
    // Handedness of (centre, right, up) as seen from inside: right-handed Y-up scenes have forward x up = right.
    for (const LatLong convention : {LatLong::gltf, LatLong::filament, LatLong::openexr}) {
        const EnvironmentMap map = make_map(8, black, convention);
        const Vec3d forward = direction_of(map, {4, 2}), right = direction_of(map, {6, 2});
        EXPECT_NEAR(dot(cross(forward, {0, 1, 0}), right), convention == LatLong::filament ? -1 : 1, 1e-15);
    }
}

TEST(LatLong, RotationTurnsAboutXThenYThenZ) {
    // Right-handed quarter turns by hand: about X, Y goes to Z; about Y, Z goes to X; about Z, X goes to Y.
    expect_near(transform(rotation_matrix({90, 0, 0}), {0, 1, 0}), {0, 0, 1}, 1e-15);
    expect_near(transform(rotation_matrix({0, 90, 0}), {0, 0, 1}), {1, 0, 0}, 1e-15);
    expect_near(transform(rotation_matrix({0, 0, 90}), {1, 0, 0}), {0, 1, 0}, 1e-15);
    // In order: Y -> Z (about X) -> X (about Y) -> Y (about Z).
    expect_near(transform(rotation_matrix({90, 90, 0}), {0, 1, 0}), {1, 0, 0}, 1e-15);
    expect_near(transform(rotation_matrix({90, 90, 90}), {0, 1, 0}), {0, 1, 0}, 1e-15);
    // The other order would leave X where it is first and end in -Z.
    expect_near(transform(rotation_matrix({90, 90, 0}), {1, 0, 0}), {0, 0, -1}, 1e-15);
}

TEST(LatLong, DirectionAndPointAreInverse) {
    Random random(2);
    for (const LatLong convention : {LatLong::gltf, LatLong::filament, LatLong::openexr}) {
        const EnvironmentMap map = make_map(64, black, convention, {31, -75, 160});
        for (int k = 0; k < 500; ++k) {
            const Vec3d d = random_direction(random);
            const MapPoint p = point_of(map, d * 2.5);
            EXPECT_GE(p.x, 0);
            EXPECT_LE(p.x, 64);
            EXPECT_GE(p.y, 0);
            EXPECT_LE(p.y, 32);
            expect_near(direction_of(map, p), d, 1e-14);  // a dozen operations in double
        }
    }
}

}  // namespace
}  // namespace hairbake
