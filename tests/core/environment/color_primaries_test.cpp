#include "core/environment/color_primaries.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"

namespace hairbake {
namespace {

using Matrix = std::array<Vec3d, 3>;

Vec3d times(const Matrix& m, const Vec3d& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }

Chromaticities of(ToPrimaries target) { return chromaticities_of(target).value(); }

void expect_matrix(const Matrix& found, const double (&expected)[9], double tolerance) {
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            EXPECT_NEAR(found[row][column], expected[3 * row + column], tolerance) << row << ' ' << column;
}

TEST(ColorPrimaries, PublishedMatricesComeOut) {
    // ITU-R BT.2087, table 2, has four digits: half a unit of the last one, and the chromaticities are floats.
    expect_matrix(rgb_conversion(of(ToPrimaries::rec709), of(ToPrimaries::rec2020)),
                  {0.6274, 0.3293, 0.0433, 0.0691, 0.9195, 0.0114, 0.0164, 0.0880, 0.8956}, 6e-5);
    // Rec.709 to ACEScg with the Bradford adaptation, as the ACES project publishes it (five digits here; the white of
    // AP1 has five digits, so that the fifth of the matrix can be off by a few).
    expect_matrix(rgb_conversion(of(ToPrimaries::rec709), of(ToPrimaries::acescg)),
                  {0.61310, 0.33952, 0.04738, 0.07019, 0.91635, 0.01345, 0.02062, 0.10957, 0.86981}, 6e-5);
}

TEST(ColorPrimaries, WhiteStaysWhiteAndTheWayBackIsTheInverse) {
    for (const ToPrimaries a : {ToPrimaries::rec709, ToPrimaries::display_p3, ToPrimaries::aces})
        for (const ToPrimaries b : {ToPrimaries::rec2020, ToPrimaries::acescg, ToPrimaries::aces}) {
            const Matrix there = rgb_conversion(of(a), of(b)), back = rgb_conversion(of(b), of(a));
            // Rounding of doubles; no entry of these matrices is above 3.
            EXPECT_LT(length(times(there, Vec3d(1)) - Vec3d(1)), 1e-14);
            const Vec3d color{0.25, -0.5, 2};
            EXPECT_LT(length(times(back, times(there, color)) - color), 1e-13);
        }
}

TEST(ColorPrimaries, PrimariesWithoutAMeaningHaveAFault) {
    for (const ToPrimaries known :
         {ToPrimaries::rec709, ToPrimaries::rec2020, ToPrimaries::display_p3, ToPrimaries::acescg, ToPrimaries::aces})
        EXPECT_EQ(fault_of(of(known)), "");
    const Chromaticities good = default_chromaticities();
    const auto changed = [&](int index, float value) {
        Chromaticities xy = good;
        xy[index] = value;
        return fault_of(xy);
    };
    EXPECT_NE(fault_of({}), "") << "all zero";
    EXPECT_NE(fault_of({.3f, .3f, .3f, .3f, .3f, .3f, .3f, .3f}), "") << "one point";
    EXPECT_NE(fault_of({.1f, .1f, .2f, .2f, .3f, .3f, .3f, .3f}), "") << "on a line";
    EXPECT_NE(changed(6, .9f), "") << "white outside";
    EXPECT_NE(changed(7, 0.f), "") << "white without luminance";
    EXPECT_NE(changed(0, NAN), "");
}

TEST(ColorPrimaries, NamesAreThoseOfKnownSpaces) {
    EXPECT_EQ(name_of(of(ToPrimaries::acescg)), "ACEScg AP1");
    EXPECT_EQ(name_of(Chromaticities{.7f, .3f, .2f, .8f, .1f, .1f, .3f, .3f}),
              "custom: red 0.7 0.3, green 0.2 0.8, blue 0.1 0.1, white 0.3 0.3");
    EXPECT_FALSE(chromaticities_of(ToPrimaries::file));
}

}  // namespace
}  // namespace hairbake
