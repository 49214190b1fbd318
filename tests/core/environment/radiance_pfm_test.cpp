// Radiance HDR and PFM files as people have them, and pictures that are not read, written byte by byte.
#include <gtest/gtest.h>

#include "tests/core/environment/picture_files.h"
#include "tests/support/make_map.h"
#include "tests/support/temporary_folder.h"

namespace hairbake::radiance_pfm_test {
namespace {

using namespace picture_files;
using test_support::TemporaryFolder;
using testing::noise_map;

constexpr int width = 16, height = 8;

/// The radiance of pixel (x, y) in the pictures below: RGBE (128 + x, 128 + y, 64, 129) is this, exactly.
Vec3f expected(int x, int y) { return {float(128 + x) / 128, float(128 + y) / 128, 0.5f}; }

/// Flat RGBE pixels in an axis order such as "-Y 8 +X 16".
std::string radiance_pixels(const std::string& axes) {
    const bool columns = axes[1] == 'X';
    const bool left = axes.find("-X") != std::string::npos, up = axes.find("+Y") != std::string::npos;
    std::string bytes;
    for (int line = 0; line < (columns ? width : height); ++line)
        for (int i = 0; i < (columns ? height : width); ++i) {
            const int x = columns ? line : i, y = columns ? i : line;
            bytes +=
                {char(128 + (left ? width - 1 - x : x)), char(128 + (up ? height - 1 - y : y)), char(64), char(129)};
        }
    return bytes;
}

std::string radiance_file(const std::string& variables, const std::string& axes = "-Y 8 +X 16") {
    return "#?RADIANCE\n" + variables + "\n" + axes + "\n" + radiance_pixels(axes);
}

const std::string rgbe = "FORMAT=32-bit_rle_rgbe\n";

void expect_picture(const EnvironmentMap& map, const Vec3f& factor = Vec3f(1)) {
    ASSERT_EQ(map.width, width);
    ASSERT_EQ(map.height, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            ASSERT_EQ(map.pixels[std::size_t(y) * width + x], expected(x, y) * factor) << x << ' ' << y;
}

TEST(RadianceFiles, AllEightAxisOrdersGiveTheSamePicture) {
    const TemporaryFolder folder;
    for (const std::string y : {"-Y 8", "+Y 8"})
        for (const std::string x : {"-X 16", "+X 16"})
            for (const std::string& axes : {y + " " + x, x + " " + y}) {
                SCOPED_TRACE(axes);
                save_picture(folder / "a.hdr", radiance_file(rgbe, axes));
                expect_picture(read_picture(folder / "a.hdr"));
            }
}

TEST(RadianceFiles, LinesMayEndWithCrLfAndTheFormatMayBeMissing) {
    const TemporaryFolder folder;
    save_picture(folder / "a.hdr",
                 "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 8 +X 16\r\n" + radiance_pixels("-Y 8 +X 16"));
    expect_picture(read_picture(folder / "a.hdr"));
    save_picture(folder / "b.hdr", radiance_file("SOFTWARE=somebody's\n"));
    expect_picture(read_picture(folder / "b.hdr"));
}

TEST(RadianceFiles, ExposureAndColourCorrectionAreTakenOff) {
    const TemporaryFolder folder;
    // Radiance's rule: several values multiply, and the pixels are radiance times their product. Powers of two: exact.
    save_picture(folder / "a.hdr", radiance_file(rgbe + "EXPOSURE=2\nCOLORCORR= 1 2 0.5\nEXPOSURE = 4.0\n"));
    const EnvironmentMap map = read_picture(folder / "a.hdr");
    expect_picture(map, {1 / 8.f, 1 / 16.f, 1 / 4.f});
    EXPECT_TRUE(warns(map, "divided by the header's exposure"));
    save_picture(folder / "b.hdr", radiance_file(rgbe + "EXPOSURE=0\n"));
    EXPECT_NE(picture_refusal(folder / "b.hdr").find("EXPOSURE is 0"), std::string::npos);
    save_picture(folder / "c.hdr", radiance_file(rgbe + "EXPOSURE=bright\n"));
    EXPECT_NE(picture_refusal(folder / "c.hdr").find("EXPOSURE is \"bright\""), std::string::npos);
}

TEST(RadianceFiles, PrimariesAreRead) {
    const TemporaryFolder folder;
    save_picture(folder / "a.hdr", radiance_file(rgbe + "PRIMARIES= .708 .292 .170 .797 .131 .046 .3127 .3290\n"));
    EXPECT_EQ(read_picture(folder / "a.hdr").primaries.name, "Rec.2020");
    save_picture(folder / "b.hdr", radiance_file(rgbe + "PRIMARIES= 0 0 0 0 0 0 0 0\n"));
    const EnvironmentMap map = read_picture(folder / "b.hdr");
    EXPECT_EQ(map.primaries.name, "unspecified");
    EXPECT_TRUE(warns(map, "primaries were not used"));
}

/// A file of 16 x 8 equal pixels.
std::string one_colour(const std::string& variables, const std::string& pixel) {
    std::string bytes = "#?RADIANCE\n" + variables + "\n-Y 8 +X 16\n";
    for (int i = 0; i < 8 * 16; ++i) bytes += pixel;
    return bytes;
}

// The pixel (64, 64, 64, 136) is 64.5 / 256 * 2^8 = 64.5 for each of X, Y and Z (or 64, by the reader's rounding):
// the white of Radiance's primaries, so R = G = B = 64.5 / 179. Relatives: an exposure, and the primaries that name
// themselves.
TEST(RadianceFiles, XyzIsConvertedToRadiance) {
    const TemporaryFolder folder;
    const std::string pixel("\x40\x40\x40\x88", 4);
    save_picture(folder / "xyze.hdr", one_colour("FORMAT=32-bit_rle_xyze\n", pixel));
    save_picture(folder / "exposed.hdr", one_colour("FORMAT=32-bit_rle_xyze\nEXPOSURE=4\n", pixel));
    const EnvironmentMap map = read_picture(folder / "xyze.hdr"), exposed = read_picture(folder / "exposed.hdr");
    for (const int channel : {0, 1, 2}) {
        EXPECT_NEAR(map.pixels[5][channel], 64.25 / 179, 0.3 / 179);
        EXPECT_NEAR(map.pixels[5][channel], map.pixels[5][0], 1e-5);  // chromaticities are stored as floats
        EXPECT_NEAR(exposed.pixels[5][channel], map.pixels[5][channel] / 4, 1e-6);
    }
    EXPECT_TRUE(warns(map, "CIE XYZ"));
    EXPECT_TRUE(map.primaries.xy.has_value());
    // More X than Y: red.
    save_picture(folder / "red.hdr", one_colour("FORMAT=32-bit_rle_xyze\n", std::string("\x50\x40\x30\x88", 4)));
    const EnvironmentMap red = read_picture(folder / "red.hdr");
    EXPECT_GT(red.pixels[0].x, red.pixels[0].y);
}

TEST(RadianceFiles, FilesThatAreNotReadSayTheTrueReason) {
    const TemporaryFolder folder;
    save_picture(folder / "other.hdr", radiance_file("FORMAT=32-bit_rle_spec\n"));
    EXPECT_NE(picture_refusal(folder / "other.hdr").find("32-bit_rle_spec; allowed are"), std::string::npos);
    // Radiance's first run-length code: a pixel, and 15 times the same.
    std::string runs;
    for (int y = 0; y < height; ++y) runs += std::string("\x80\x80\x40\x81\x01\x01\x01\x0f", 8);
    save_picture(folder / "old.hdr", "#?RADIANCE\n" + rgbe + "\n-Y 8 +X 16\n" + runs);
    EXPECT_NE(picture_refusal(folder / "old.hdr").find("before 1991"), std::string::npos);
    save_picture(folder / "endless.hdr", "#?RADIANCE\n" + std::string(100000, 'x'));
    EXPECT_NE(picture_refusal(folder / "endless.hdr").find("has no end"), std::string::npos);
    save_picture(folder / "size.hdr", "#?RADIANCE\n" + rgbe + "\n-Y 8 +Y 16\n");
    EXPECT_NE(picture_refusal(folder / "size.hdr").find("\"-Y 8 +Y 16\""), std::string::npos);
    save_picture(folder / "short.hdr", radiance_file(rgbe).substr(0, 200));
    EXPECT_NE(picture_refusal(folder / "short.hdr"), "");
}

TEST(PfmFiles, LinesMayEndWithCrLf) {
    const TemporaryFolder folder;
    const EnvironmentMap map = noise_map(width, 1);
    std::string rows;
    for (int y = height - 1; y >= 0; --y)
        rows.append(reinterpret_cast<const char*>(map.pixels.data() + std::size_t(y) * width), width * sizeof(Vec3f));
    for (const std::string header :
         {"PF\n16 8\n-1.0\n", "PF\r\n16 8\r\n-1.0\r\n", "PF\r\n# somebody's\r\n16 8\r\n-1\r\n"}) {
        save_picture(folder / "a.pfm", header + rows);
        EXPECT_EQ(read_picture(folder / "a.pfm").pixels, map.pixels) << header;
    }
}

TEST(OtherPictures, AreRefusedByTheirName) {
    const TemporaryFolder folder;
    using namespace std::string_literals;
    const std::vector<std::pair<std::string, std::string>> files{
        {"\xff\xd8\xff\xe0"s + std::string(100, 'x'), "a JPEG picture"},
        {"\xff\xd8\xff\xe1"s + "xmlns:hdrgm=\"..\" hdrgm:Version=\"1.0\"", "an Ultra-HDR JPEG"},
        {"RIFFxxxxWEBP", "a WebP picture"},
        {"xxxxftypavif", "an AVIF picture"},
        {"DDS xxxxxxxx", "a DDS texture"},
        {"", "an empty file"},
        {"just a text", "no known image"}};
    for (const auto& [bytes, name] : files) {
        save_picture(folder / "a.hdr", bytes);
        EXPECT_NE(picture_refusal(folder / "a.hdr").find(name), std::string::npos) << picture_refusal(folder / "a.hdr");
    }
}

}  // namespace
}  // namespace hairbake::radiance_pfm_test
