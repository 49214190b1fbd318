// Primaries of environments, their conversion, and invalid radiance under the policy auto.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/environment/radiance_repair.h"
#include "tests/core/environment/picture_files.h"
#include "tests/support/make_map.h"
#include "tests/support/temporary_folder.h"

namespace hairbake::colors_and_repair_test {
namespace {

using namespace picture_files;
using test_support::TemporaryFolder;

constexpr int width = 16, height = 8;

ExrHeader with_primaries(const Chromaticities& xy) {
    ExrHeader header;
    header.chromaticities = xy;
    return header;
}

TEST(Primaries, ColoursAreConvertedOnRequestAlone) {
    const TemporaryFolder folder;
    // In Rec.2020: white, and Rec.709's green, which BT.2087's matrix gives as its second column.
    std::vector<Vec3f> pixels(std::size_t(width) * height, Vec3f(2));
    pixels[3] = {0.3293f, 0.9195f, 0.0880f};
    write_exr(folder / "a.exr", width, height, pixels, with_primaries(*chromaticities_of(ToPrimaries::rec2020)));
    EXPECT_EQ(read_picture(folder / "a.exr").pixels, pixels);
    EnvironmentSettings settings;
    settings.to_primaries = ToPrimaries::rec709;
    const EnvironmentMap map = read_picture(folder / "a.exr", settings);
    EXPECT_EQ(map.primaries.name, "Rec.709");
    EXPECT_EQ(map.primaries.xy, chromaticities_of(ToPrimaries::rec709));
    EXPECT_LT(length(map.pixels[0] - Vec3f(2)), 1e-6f);
    // Four digits of the matrix, times entries of the inverse below 2.
    EXPECT_LT(length(map.pixels[3] - Vec3f{0, 1, 0}), 3e-4f);
}

TEST(Primaries, AFileThatNamesNoneIsTakenAsRec709WithAWarning) {
    const TemporaryFolder folder;
    std::string pixels;
    for (int i = 0; i < width * height; ++i) pixels += "\x80\x40\x20\x81";  // 1, 1/2, 1/4
    save_picture(folder / "a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n" + pixels);
    EnvironmentSettings settings;
    settings.to_primaries = ToPrimaries::rec709;
    const EnvironmentMap map = read_picture(folder / "a.hdr", settings);
    EXPECT_EQ(map.pixels[5], (Vec3f{1, 0.5f, 0.25f}));
    EXPECT_TRUE(warns(map, "names no primaries"));
    EXPECT_EQ(map.primaries.name, "Rec.709");
}

TEST(Primaries, ColoursOutsideTheTargetAreInvalidRadiance) {
    const TemporaryFolder folder;
    // Rec.2020's green is outside Rec.709: red of it is about -0.59.
    write_exr(folder / "a.exr", width, height, std::vector<Vec3f>(std::size_t(width) * height, Vec3f{0, 1, 0}),
              with_primaries(*chromaticities_of(ToPrimaries::rec2020)));
    EnvironmentSettings settings;
    settings.to_primaries = ToPrimaries::rec709;
    const std::string message = picture_refusal(folder / "a.exr", settings);
    EXPECT_NE(message.find("converted to Rec.709"), std::string::npos) << message;
    settings.invalid_radiance = InvalidRadiance::clamp;
    const EnvironmentMap map = read_picture(folder / "a.exr", settings);
    EXPECT_EQ(map.pixels[0].x, 0);
    EXPECT_GT(map.pixels[0].y, 1);
    EXPECT_TRUE(warns(map, "colours outside Rec.709"));
}

TEST(InvalidRadiance, AutoRepairsALittleAndRefusesMoreThanAHundredth) {
    const TemporaryFolder folder;
    const auto file_with = [&](float value, int pixels) {
        EnvironmentMap map = testing::make_map(64, [](const Vec3d&) { return Vec3d{1, 1, 1}; });
        for (int i = 0; i < pixels; ++i) map.pixels[16 * 64 + i].y = value;
        write_exr(folder / "a.exr", 64, 32, map.pixels);
        return folder / "a.exr";
    };
    // A texel at the equator is (pi/32)^2 of 4 pi sr, 7.7e-4 of the sphere, and a channel holds a third of the light.
    const double share = std::acos(-1) / 32 * std::acos(-1) / 32 / (4 * std::acos(-1)) / 3;
    const EnvironmentMap tiny = read_picture(file_with(-1e-6f, 1));
    EXPECT_EQ(tiny.repairs.negative_pixels, 1u);
    EXPECT_TRUE(tiny.warnings.empty()) << "below a millionth of the light";
    EXPECT_NEAR(invalid_share(tiny.repairs), 1e-6 * share, 1e-8 * share);
    const EnvironmentMap some = read_picture(file_with(-0.01f, 1));
    EXPECT_TRUE(warns(some, "1 pixel with negative radiance was set to 0"));
    // 0.01 of the light is 39 such texels with -1, whose own light is missing too.
    EXPECT_EQ(picture_refusal(file_with(-1, int(0.9 * 0.01 / share))), "");
    const std::string message = picture_refusal(file_with(-1, int(1.1 * 0.01 / share) + 1));
    EXPECT_NE(message.find("green radiance at pixel (0, 16) is -1"), std::string::npos) << message;
    EXPECT_NE(message.find("invalid_radiance = clamp"), std::string::npos) << message;
    // NaN and infinity have no energy: their share of the sphere counts, three times a channel's.
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    EXPECT_TRUE(warns(read_picture(file_with(nan, 1)), "NaN"));
    EXPECT_TRUE(warns(read_picture(file_with(infinity, 1)), "infinite"));
    EXPECT_EQ(picture_refusal(file_with(nan, 12)), "");
    EXPECT_NE(picture_refusal(file_with(nan, 14)), "");
    EXPECT_NE(picture_refusal(file_with(infinity, 14)), "");
    EnvironmentSettings settings;
    settings.invalid_radiance = InvalidRadiance::clamp;
    EXPECT_EQ(picture_refusal(file_with(nan, 60), settings), "");
    // Nothing but negative light.
    write_exr(folder / "b.exr", width, height, std::vector<Vec3f>(std::size_t(width) * height, Vec3f(-1)));
    EXPECT_NE(picture_refusal(folder / "b.exr"), "");
}

}  // namespace
}  // namespace hairbake::colors_and_repair_test
