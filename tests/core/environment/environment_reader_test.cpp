#include "core/environment/environment_reader.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>

#include "core/environment/environment_writer.h"
#include "core/sample/sky_generator.h"
#include "tests/support/make_map.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using test_support::TemporaryFolder;
using testing::make_map;
using testing::noise_map;

EnvironmentMap read(const std::filesystem::path& file, const EnvironmentSettings& settings = {}) {
    Progress progress;
    return read_environment(file, settings, progress);
}

std::string message_of(const std::filesystem::path& file, const EnvironmentSettings& settings = {}) {
    try {
        read(file, settings);
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

// Writes with OpenImageIO, so that not our own writer is read.
void write(const std::filesystem::path& file, const EnvironmentMap& map, const OIIO::TypeDesc& type,
           const std::function<void(OIIO::ImageSpec&)>& change = {}, int channels = 3) {
    OIIO::ImageSpec spec(map.width, map.height, channels, type);
    if (change) change(spec);
    std::vector<float> values;
    for (const Vec3f& p : map.pixels)
        for (int c = 0; c < channels; ++c) values.push_back(c < 3 ? p[c] : 0.25f);
    const auto output = OIIO::ImageOutput::create(file.string());
    ASSERT_TRUE(output && output->open(file.string(), spec)) << OIIO::geterror();
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data())) << output->geterror();
    ASSERT_TRUE(output->close());
}

// PFM by hand: rows from the bottom up, little endian.
void write_pfm(const std::filesystem::path& file, const EnvironmentMap& map) {
    std::ofstream out(file, std::ios::binary);
    out << "PF\n" << map.width << ' ' << map.height << "\n-1.0\n";
    for (int y = map.height - 1; y >= 0; --y)
        out.write(reinterpret_cast<const char*>(map.pixels.data() + std::size_t(y) * map.width),
                  std::streamsize(map.width * sizeof(Vec3f)));
}

double worst_difference(const EnvironmentMap& a, const EnvironmentMap& b) {
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    double worst = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        worst = std::max(worst, double(length(a.pixels[i] - b.pixels[i])));
    return worst;
}

TEST(EnvironmentReader, FloatFormatsComeBackExactly) {
    const TemporaryFolder folder;
    const EnvironmentMap map = noise_map(64, 1);
    write(folder / "a.exr", map, OIIO::TypeDesc::FLOAT);
    write(folder / "tiled.exr", map, OIIO::TypeDesc::FLOAT,
          [](OIIO::ImageSpec& s) { s.tile_width = s.tile_height = 16; });
    write(folder / "a.tif", map, OIIO::TypeDesc::FLOAT);
    write_pfm(folder / "a.pfm", map);
    for (const char* name : {"a.exr", "tiled.exr", "a.tif", "a.pfm"}) {
        const EnvironmentMap back = read(folder / name);
        EXPECT_EQ(worst_difference(map, back), 0) << name;
        EXPECT_FALSE(back.low_dynamic_range);
        EXPECT_TRUE(back.warnings.empty()) << name << ": " << back.warnings.front();
    }
    EXPECT_EQ(read(folder / "a.exr").source_format, "openexr");
    EXPECT_EQ(read(folder / "a.tif").source_format, "tiff");
}

TEST(EnvironmentReader, HdrComesBackWithinItsEightBits) {
    const TemporaryFolder folder;
    const EnvironmentMap map = noise_map(64, 2);
    write(folder / "a.hdr", map, OIIO::TypeDesc::FLOAT);
    const EnvironmentMap back = read(folder / "a.hdr");
    // RGBE: the largest channel has 8 bits, so a step is 1/128 of it at worst; truncation in each of 3 channels
    // below 1.
    EXPECT_LT(worst_difference(map, back), std::sqrt(3.0) / 128);
    EXPECT_EQ(back.source_format, "hdr");
}

TEST(EnvironmentReader, IntegersAreDecodedAsSrgbAndWarnedOf) {
    const TemporaryFolder folder;
    // IEC 61966-2-1 by hand: code 0.5 is ((0.5 + 0.055) / 1.055)^2.4 = 0.214041; 0.02 is 0.02 / 12.92 = 0.001548.
    const EnvironmentMap map = make_map(16, [](const Vec3d&) { return Vec3d{0.5, 0.02, 1}; });
    const auto check = [&](const char* name, const OIIO::TypeDesc& type, double steps) {
        write(folder / name, map, type);
        const EnvironmentMap back = read(folder / name);
        EXPECT_TRUE(back.low_dynamic_range);
        ASSERT_FALSE(back.warnings.empty());
        EXPECT_NE(back.warnings.front().find("sRGB"), std::string::npos);
        // Half a code step times the curve's slope, at most 2.4 / 1.055.
        EXPECT_NEAR(back.pixels[5].x, 0.214041, 0.5 / steps * 2.3);
        EXPECT_NEAR(back.pixels[5].y, 0.001548, 0.5 / steps * 2.3);
        EXPECT_NEAR(back.pixels[5].z, 1, 1e-6);
    };
    check("eight.png", OIIO::TypeDesc::UINT8, 255);
    check("sixteen.png", OIIO::TypeDesc::UINT16, 65535);
    check("eight.tif", OIIO::TypeDesc::UINT8, 255);
}

TEST(EnvironmentReader, AlphaIsDroppedGreyIsSpreadAndChannelsAreFoundByName) {
    const TemporaryFolder folder;
    const EnvironmentMap map = noise_map(16, 3);
    write(folder / "rgba.exr", map, OIIO::TypeDesc::FLOAT, {}, 4);
    EXPECT_EQ(worst_difference(map, read(folder / "rgba.exr")), 0);
    EXPECT_EQ(read(folder / "rgba.exr").warnings.size(), 1u);

    write(folder / "grey.exr", map, OIIO::TypeDesc::FLOAT, {}, 1);
    const EnvironmentMap grey = read(folder / "grey.exr");
    EXPECT_EQ(grey.pixels[9], Vec3f(map.pixels[9].x));

    write(folder / "swapped.tif", map, OIIO::TypeDesc::FLOAT);  // TIFF keeps no names
    write(folder / "layer.exr", map, OIIO::TypeDesc::FLOAT, [](OIIO::ImageSpec& s) {
        s.channelnames = {"sky.G", "sky.R", "sky.B"};
    });
    const EnvironmentMap named = read(folder / "layer.exr");
    EXPECT_EQ(named.pixels[9], (Vec3f{map.pixels[9].y, map.pixels[9].x, map.pixels[9].z}));
}

TEST(EnvironmentReader, AnAlphaThatIsApartFromTheColoursLeavesThemAsTheyAre) {
    const TemporaryFolder folder;
    const EnvironmentMap map = make_map(16, [](const Vec3d& d) { return Vec3d{0.5 + 0.4 * d.x, 0.7, 1}; });
    const auto apart = [](OIIO::ImageSpec& s) { s.attribute("oiio:UnassociatedAlpha", 1); };
    const auto check = [&](const std::string& name, const OIIO::TypeDesc& type) {
        write(folder / ("rgb_" + name), map, type);
        write(folder / ("rgba_" + name), map, type, apart, 4);
        // The alpha of 1/4 is dropped, so the same numbers are stored for the colours: no difference at all.
        EXPECT_EQ(worst_difference(read(folder / ("rgb_" + name)), read(folder / ("rgba_" + name))), 0) << name;
    };
    check("eight.png", OIIO::TypeDesc::UINT8);
    check("sixteen.png", OIIO::TypeDesc::UINT16);
    check("eight.tif", OIIO::TypeDesc::UINT8);
    check("float.tif", OIIO::TypeDesc::FLOAT);
}

TEST(EnvironmentReader, PrimariesAreNamed) {
    const TemporaryFolder folder;
    const EnvironmentMap map = noise_map(16, 4);
    const auto with = [](std::array<float, 8> xy) {
        return [xy](OIIO::ImageSpec& s) {
            s.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy.data());
        };
    };
    write(folder / "ap1.exr", map, OIIO::TypeDesc::HALF,
          with({.713f, .293f, .165f, .83f, .128f, .044f, .32168f, .33767f}));
    write(folder / "odd.exr", map, OIIO::TypeDesc::HALF, with({.7f, .3f, .2f, .8f, .1f, .1f, .3f, .3f}));
    write(folder / "none.exr", map, OIIO::TypeDesc::HALF);
    EXPECT_EQ(read(folder / "ap1.exr").primaries.name, "ACEScg AP1");
    EXPECT_EQ(read(folder / "odd.exr").primaries.name.substr(0, 6), "custom");
    EXPECT_EQ(read(folder / "none.exr").primaries.name, "unspecified");
}

TEST(EnvironmentReader, ExposureTintConventionAndRotationAreTaken) {
    const TemporaryFolder folder;
    const EnvironmentMap map = noise_map(16, 5);
    write(folder / "a.exr", map, OIIO::TypeDesc::FLOAT);
    EnvironmentSettings settings;
    settings.exposure_stops = 2;
    settings.tint = {1, 0.5, 0};
    settings.latlong = LatLong::openexr;
    settings.rotation_deg = {90, 0, 0};
    const EnvironmentMap back = read(folder / "a.exr", settings);
    // Powers of two: exact.
    EXPECT_EQ(back.pixels[7], (Vec3f{map.pixels[7].x * 4, map.pixels[7].y * 2, 0}));
    EXPECT_EQ(back.latlong, LatLong::openexr);
    EXPECT_LT(length(back.rotation[2] - Vec3d{0, 1, 0}), 1e-15);
    settings.exposure_stops = 64;
    EXPECT_EQ(message_of(folder / "a.exr", settings), "no error");
}

TEST(EnvironmentReader, InvalidRadianceIsRefusedNamingThePixelOrClampedAndCounted) {
    const TemporaryFolder folder;
    EnvironmentMap map = make_map(16, [](const Vec3d&) { return Vec3d{1, 2, 3}; });
    map.pixels[2 * 16 + 5].y = -4;
    map.pixels[3 * 16 + 1].z = std::numeric_limits<float>::quiet_NaN();
    map.pixels[4 * 16 + 2].x = std::numeric_limits<float>::infinity();
    map.pixels[5 * 16 + 3].x = -std::numeric_limits<float>::infinity();
    write(folder / "bad.exr", map, OIIO::TypeDesc::FLOAT);
    EnvironmentSettings settings;
    settings.invalid_radiance = InvalidRadiance::reject;
    const std::string message = message_of(folder / "bad.exr", settings);
    EXPECT_NE(message.find("green radiance at pixel (5, 2) is -4"), std::string::npos) << message;

    settings.invalid_radiance = InvalidRadiance::clamp;
    settings.exposure_stops = 1;
    const EnvironmentMap back = read(folder / "bad.exr", settings);
    EXPECT_EQ(back.repairs.negative_pixels, 1u);
    EXPECT_EQ(back.repairs.nan_pixels, 1u);
    EXPECT_EQ(back.repairs.infinite_pixels, 2u);
    EXPECT_EQ(back.pixels[2 * 16 + 5], (Vec3f{2, 0, 6}));
    EXPECT_EQ(back.pixels[3 * 16 + 1], (Vec3f{2, 4, 0}));
    EXPECT_EQ(back.pixels[4 * 16 + 2], (Vec3f{6, 4, 6}));  // the largest finite value is 3
    EXPECT_EQ(back.pixels[5 * 16 + 3], (Vec3f{0, 4, 6}));
    // By hand, in the file's unit: the negative value's 4 times the solid angle of its row.
    const std::vector<double> omega = latlong_rows(16, 8).solid_angle;
    EXPECT_NEAR(back.repairs.energy_removed, 4 * omega[2], 1e-12);
    const double total = 6 * 4 * std::numbers::pi - 2 * omega[2] - 3 * omega[3] + 2 * omega[4] - 1 * omega[5];
    EXPECT_NEAR(back.repairs.energy_total, total, 1e-12);
}

TEST(EnvironmentReader, EveryKindOfRepairIsWarnedOfWithItsCountAndWhatItBecame) {
    const TemporaryFolder folder;
    constexpr float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const auto warnings = [&](const std::vector<float>& invalid) {
        EnvironmentMap map = make_map(16, [](const Vec3d&) { return Vec3d{1, 1, 1}; });
        for (std::size_t i = 0; i < invalid.size(); ++i) map.pixels[i].y = invalid[i];
        write(folder / "bad.exr", map, OIIO::TypeDesc::FLOAT);
        EnvironmentSettings settings;
        settings.invalid_radiance = InvalidRadiance::clamp;
        return read(folder / "bad.exr", settings).warnings;
    };
    using Texts = std::vector<std::string>;
    EXPECT_EQ(warnings({}), Texts{});
    EXPECT_EQ(warnings({nan}), Texts{"1 pixel with NaN radiance was set to 0"});
    EXPECT_EQ(warnings({infinity, infinity}),
              Texts{"2 pixels with infinite radiance were set to the largest finite value (-infinity to 0)"});
    // All at once, and the share of the light that the negative pixel took away.
    const Texts all = warnings({-1, nan, infinity});
    ASSERT_EQ(all.size(), 1u);
    EXPECT_TRUE(all[0].starts_with("1 pixel with negative radiance was set to 0, ")) << all[0];
    EXPECT_NE(all[0].find(" % of the light; 1 pixel with NaN radiance was set to 0; 1 pixel with infinite radiance"),
              std::string::npos)
        << all[0];
}

TEST(EnvironmentReader, WrongSettingsAreUsageErrorsNamingTheField) {
    const auto field_of = [](const EnvironmentSettings& settings) -> std::string {
        try {
            read("nowhere.exr", settings);
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::usage);
            return e.field();
        }
        return "";
    };
    EnvironmentSettings settings;
    settings.tint = {1, -1, 1};
    EXPECT_EQ(field_of(settings), "environment_settings.tint");
    settings = {};
    settings.exposure_stops = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(field_of(settings), "environment_settings.exposure_stops");
}

TEST(EnvironmentReader, ACancelledReadStops) {
    const TemporaryFolder folder;
    write_environment(generate_sky(Sky::overcast, 256, 1), folder / "a.hdr");
    Progress progress;
    progress.cancel();
    try {
        read_environment(folder / "a.hdr", {}, progress);
        FAIL() << "not cancelled";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::cancelled);
    }
}

TEST(EnvironmentWriter, ItsFilesComeBack) {
    const TemporaryFolder folder;
    const EnvironmentMap map = generate_sky(Sky::sunny, 128, 1);
    write_environment(map, folder / "a.exr");
    EXPECT_EQ(worst_difference(map, read(folder / "a.exr")), 0);
    write_environment(map, folder / "a.hdr");
    const EnvironmentMap back = read(folder / "a.hdr");
    for (std::size_t i = 0; i < map.pixels.size(); ++i) {
        const Vec3f& p = map.pixels[i];
        // One step of the shared exponent: 1/128 of the largest channel.
        EXPECT_LE(length(back.pixels[i] - p), std::sqrt(3.0f) / 128 * std::max({p.x, p.y, p.z}));
    }
    EXPECT_THROW(write_environment(map, folder / "a.png"), Error);
    EXPECT_THROW(write_environment(map, folder / "no" / "folder.exr"), Error);
}

TEST(EnvironmentReader, RealMapsAreRead) {
    const auto folder = test_support::shared_data("env");
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << test_support::missing_data(folder);
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const EnvironmentMap map = read(entry.path());
        EXPECT_EQ(map.width, 2 * map.height);
        EXPECT_GT(map.repairs.energy_total, 0);
        EXPECT_EQ(map.repairs.negative_pixels + map.repairs.nan_pixels + map.repairs.infinite_pixels, 0u);
    }
    // CREDITS.md: the sunny sky's maximum is 98,163 x mean (mean and maximum over channels as it took them: within 10
    // %).
    const EnvironmentMap sunny = read(folder / "kloppenheim_05_1k.hdr");
    double peak = 0;
    for (const Vec3f& p : sunny.pixels) peak = std::max(peak, (double(p.x) + p.y + p.z) / 3);
    EXPECT_NEAR(peak / (sunny.repairs.energy_total / 3 / (4 * std::numbers::pi)), 98163, 9816);
}

}  // namespace
}  // namespace hairbake
