#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdint>
#include <fstream>
#include <optional>

#include "core/environment/environment_reader.h"
#include "core/environment/environment_writer.h"
#include "tests/support/make_map.h"
#include "tests/support/temporary_folder.h"

#ifdef __SANITIZE_ADDRESS__
// OpenImageIO 2.4 leaks a 31-byte string when libpng jumps out of its read callback at the end of a broken file. To
// know such a leak by its stack, the sanitizer must unwind through libraries without frame pointers.
extern "C" const char* __lsan_default_suppressions() { return "leak:PNGInput::PngReadCallback\n"; }
extern "C" const char* __asan_default_options() { return "fast_unwind_on_malloc=0"; }
#endif

namespace hairbake {
namespace {

using test_support::TemporaryFolder;

void save(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
}

std::string load(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::string refusal(const std::filesystem::path& file) {
    Progress progress;
    try {
        read_environment(file, {}, progress);
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::bad_input);
        EXPECT_NE(std::string(e.what()).find(file.filename().string()), std::string::npos) << "names no file";
        return e.what();
    }
    return "";
}

// What earlier tests took must not hide what this one takes: Linux counts anew when 5 is written here.
void forget_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

long peak_kilobytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

std::string little(std::uint32_t v) {
    return {char(v & 255), char(v >> 8 & 255), char(v >> 16 & 255), char(v >> 24 & 255)};
}
std::string little16(std::uint32_t v) { return {char(v & 255), char(v >> 8 & 255)}; }
std::string big(std::uint32_t v) {
    return {char(v >> 24 & 255), char(v >> 16 & 255), char(v >> 8 & 255), char(v & 255)};
}

// Next to no pixels, and `padding` bytes for them.
std::string pixels_of(std::size_t padding) { return std::string(64 + padding, '\0'); }

std::string exr_attribute(const std::string& name, const std::string& type, const std::string& value) {
    return name + '\0' + type + '\0' + little(std::uint32_t(value.size())) + value;
}

// A complete OpenEXR header (half channels, ZIP) declaring any size; `rest` are further attributes.
std::string exr_header(std::uint32_t width, std::uint32_t height,
                       const std::vector<std::string>& names = {"B", "G", "R"}, const std::string& rest = "",
                       std::uint32_t flags = 0) {
    std::string channels;
    for (const std::string& c : names) channels += c + '\0' + little(1) + little(0) + little(1) + little(1);
    const std::string window = little(0) + little(0) + little(width - 1) + little(height - 1), one = little(0x3f800000);
    return little(20000630) + little(2 | flags) + exr_attribute("channels", "chlist", channels + '\0') +
           exr_attribute("compression", "compression", "\3") + exr_attribute("dataWindow", "box2i", window) +
           exr_attribute("displayWindow", "box2i", window) +
           exr_attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
           exr_attribute("pixelAspectRatio", "float", one) +
           exr_attribute("screenWindowCenter", "v2f", little(0) + little(0)) +
           exr_attribute("screenWindowWidth", "float", one) + rest + '\0';
}

// The same with 64 channels in tiles.
std::string tiled_exr_header(std::uint32_t width, std::uint32_t height, std::uint32_t tile_width,
                             std::uint32_t tile_height) {
    std::vector<std::string> names{"R", "G", "B"};
    for (int c = 3; c < 64; ++c) names.push_back({char('A' + c / 10), char('0' + c % 10)});
    const std::string tiles = little(tile_width) + little(tile_height) + '\0';
    return exr_header(width, height, names, exr_attribute("tiles", "tiledesc", tiles), 0x200);
}

struct Tile {
    std::uint32_t width, height, depth = 1;
};

// A TIFF (8 bits a sample, deflate) of one strip or tile.
std::string tiff_header(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                        const std::optional<Tile>& one_tile = {}) {
    std::string entries;
    const auto number = [&](std::uint32_t tag, std::uint32_t value) {
        entries += little16(tag) + little16(4) + little(1) + little(value);
    };
    const std::uint32_t data = 300, bytes = 64;
    using Tags = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
    const Tags strip{{256, width}, {257, height},   {258, 8},      {259, 8},    {262, 2},
                     {273, data},  {277, channels}, {278, height}, {279, bytes}};
    const Tile size = one_tile.value_or(Tile{});
    const Tags tile{{256, width}, {257, height},   {258, 8},           {259, 8},
                    {262, 2},     {277, channels}, {322, size.width},  {323, size.height},
                    {324, data},  {325, bytes},    {32998, size.depth}};
    for (const auto& [tag, value] : one_tile ? tile : strip) number(tag, value);
    const std::string file = "II" + little16(42) + little(8) + little16(std::uint32_t(entries.size() / 12)) + entries;
    return file + std::string(data - file.size(), '\0');
}

// A PNG whose first chunk declares any size (the checksum of the chunk computed as PNG's specification says), up to
// where the pixels begin.
std::string png_header(std::uint32_t width, std::uint32_t height) {
    const std::string chunk = "IHDR" + big(width) + big(height) + std::string{8, 2, 0, 0, 0};
    std::uint32_t crc = ~0u;
    for (const unsigned char byte : chunk) {
        crc ^= byte;
        for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
    }
    return "\x89PNG\r\n\x1a\n" + big(13) + chunk + big(~crc) + big(1 << 20) + "IDAT";
}

std::string hdr_header(const std::string& resolution) {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + resolution + "\n\2\2" + std::string(2, '\0');
}

TEST(HostileImage, HugeDeclaredSizesAreRefusedBeforeMemoryIsTaken) {
    const TemporaryFolder folder;
    forget_peak();
    const long before = peak_kilobytes();
    save(folder / "a.exr", exr_header(1 << 20, 1 << 19) + pixels_of(0));
    save(folder / "b.exr", exr_header(32768, 16384) + pixels_of(0));
    save(folder / "a.png", png_header(1 << 20, 1 << 19) + pixels_of(0));
    save(folder / "b.png", png_header(40000, 20000) + pixels_of(0));
    save(folder / "a.hdr", hdr_header("-Y 1073741824 +X 2147483647"));
    save(folder / "b.hdr", hdr_header("-Y 8193 +X 16386"));
    for (const char* name : {"a.exr", "b.exr", "a.png", "b.png", "a.hdr", "b.hdr"})
        EXPECT_NE(refusal(folder / name), "") << name;
    EXPECT_NE(refusal(folder / "b.hdr").find("16386 x 8193 pixels; allowed is up to 16384 x 8192"), std::string::npos);
    // The smallest of them would be 1.6 GB of pixels; the readers' own buffers stay far below 100 MB.
    EXPECT_LT(peak_kilobytes() - before, 100'000);
}

TEST(HostileImage, AnAllowedSizeThatTheFileCannotHoldIsRefusedBeforeMemoryIsTaken) {
    const TemporaryFolder folder;
    forget_peak();
    const long before = peak_kilobytes();
    save(folder / "a.hdr", hdr_header("-Y 8192 +X 16384"));
    save(folder / "a.pfm", "PF\n16384 8192\n-1.0\n1234");
    // The least that is declared are 3 x 2^27 bytes: 66,048:1 would take a file of 6,097 bytes.
    save(folder / "a.exr", exr_header(16384, 8192) + pixels_of(5000));
    save(folder / "a.png", png_header(16384, 8192) + pixels_of(5000));
    save(folder / "a.tif", tiff_header(16384, 8192, 3) + pixels_of(5000));
    save(folder / "tiled.tif", tiff_header(16384, 8192, 64, Tile{16384, 8192}) + pixels_of(0));
    for (const char* name : {"a.hdr", "a.pfm", "a.exr", "a.png", "a.tif", "tiled.tif"}) {
        const std::string size = std::to_string(std::filesystem::file_size(folder / name));
        const std::string expected = "16384 x 8192 pixels, but the file of " + size + " bytes cannot hold them";
        EXPECT_NE(refusal(folder / name).find(expected), std::string::npos) << refusal(folder / name);
    }
    // The pixels would be 1.6 GB, the row of tiles 34 GB; the readers' own buffers stay far below 100 MB.
    EXPECT_LT(peak_kilobytes() - before, 100'000);
}

TEST(HostileImage, TilesTooLargeToDecodeAreRefusedBeforeMemoryIsTaken) {
    const TemporaryFolder folder;
    forget_peak();
    const long before = peak_kilobytes();
    // Files large enough for the declared size: 16384 x 8192 x 64 bytes / 66,048 is 130,056, of halfs twice as much.
    save(folder / "a.tif", tiff_header(16384, 8192, 64, Tile{16384, 8192}) + pixels_of(140'000));
    save(folder / "a.exr", tiled_exr_header(16384, 8192, 16384, 130) + pixels_of(280'000));
    save(folder / "wide.exr", tiled_exr_header(16, 8, 16384, 130) + pixels_of(0));
    for (const auto& [name, tiles] :
         {std::pair{"a.tif", "16384 x 8192"}, {"a.exr", "16384 x 130"}, {"wide.exr", "16384 x 130"}}) {
        const std::string expected =
            std::string("the tiles are ") + tiles + " pixels of 64 channels; allowed are 512 MiB";
        EXPECT_NE(refusal(folder / name).find(expected), std::string::npos) << refusal(folder / name);
    }
    // The least of the rows of tiles would be 16384 x 130 x 64 x 4 bytes = 545 MB. OpenEXR itself sets aside addresses
    // for a tile of halfs, of which AddressSanitizer takes notes in an eighth, 34 MB.
    EXPECT_LT(peak_kilobytes() - before, 100'000);
}

TEST(HostileImage, TilesThatAreDeepOrOfNegativeSizeAreRefused) {
    // TIFF's sizes of a tile are unsigned and OpenImageIO's are int: from 2^31 on they are negative. A depth of 2^22
    // would be 16 x 16 x 3 x 2^22 floats, 13 GB, for an image of 16 x 8 pixels.
    const TemporaryFolder folder;
    forget_peak();
    const long before = peak_kilobytes();
    const std::uint32_t negative = 0x80000010u;
    for (const Tile& tile : {Tile{16, 16, 1u << 22}, Tile{16, 16, ~0u}, Tile{16, negative}, Tile{negative, 16}}) {
        save(folder / "a.tif", tiff_header(16, 8, 3, tile) + pixels_of(1000));
        EXPECT_NE(refusal(folder / "a.tif").find("a.tif: "), std::string::npos) << tile.width << " " << tile.depth;
    }
    save(folder / "a.tif", tiff_header(16, 8, 3, Tile{16, 16, 1u << 22}) + pixels_of(1000));
    EXPECT_NE(refusal(folder / "a.tif").find("the tiles are 16 x 16 x 4194304 pixels; allowed are flat ones"),
              std::string::npos)
        << refusal(folder / "a.tif");
    EXPECT_LT(peak_kilobytes() - before, 100'000);
}

// Measured on black maps of this size, those that compress best: 1024:1 (PNG), 1009:1 (deflate), 676:1 (LZW), 930:1
// (ZIP) and 23,040:1 (DWAB); of four times the width at most 1.9 times as much. 66,048:1 is allowed.
TEST(HostileImage, LargeMapsOfOneColourAreReadHoweverSmallTheirFiles) {
    const TemporaryFolder folder;
    struct Written {
        const char* name;
        const char* compression;
        OIIO::TypeDesc type;
    };
    constexpr int width = 4096, height = 2048;
    const std::vector<float> values(std::size_t(width) * height * 3, 1.0f);
    for (const auto& [name, compression, type] :
         {Written{"a.png", "zip", OIIO::TypeDesc::UINT8}, Written{"zip.tif", "zip", OIIO::TypeDesc::FLOAT},
          Written{"lzw.tif", "lzw", OIIO::TypeDesc::FLOAT}, Written{"zip.exr", "zip", OIIO::TypeDesc::HALF},
          Written{"dwab.exr", "dwab", OIIO::TypeDesc::FLOAT}}) {
        OIIO::ImageSpec spec(width, height, 3, type);
        spec.attribute("compression", compression);
        const std::filesystem::path file = folder / name;
        const auto output = OIIO::ImageOutput::create(file.string());
        ASSERT_TRUE(output->open(file.string(), spec));
        ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()));
        output->close();
        Progress progress;
        const EnvironmentMap map = read_environment(file, {}, progress);
        EXPECT_EQ(map.width, width) << name;
        // A half's step at 1, which DWA may lose; the others keep 1 exactly.
        EXPECT_NEAR(map.pixels.back().y, 1, 1.0 / 1024) << name;
    }
}

TEST(HostileImage, TruncatedFilesOfEveryFormatAreErrors) {
    const TemporaryFolder folder;
    const EnvironmentMap map = testing::noise_map(64, 1);
    for (const char* name : {"a.hdr", "a.exr", "a.tif", "a.png"}) {
        const std::filesystem::path file = folder / name;
        const bool integer = std::string(name) == "a.png";
        const auto output = OIIO::ImageOutput::create(file.string());
        ASSERT_TRUE(output->open(file.string(),
                                 OIIO::ImageSpec(64, 32, 3, integer ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT)));
        ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, map.pixels.data()));
        output->close();
        const std::string whole = load(file);
        for (const double share : {0.0, 0.005, 0.1, 0.5, 0.9}) {
            save(file, whole.substr(0, std::size_t(share * double(whole.size()))));
            EXPECT_NE(refusal(file), "") << name << " cut to " << share;
        }
    }
}

TEST(HostileImage, DamagedFilesNeitherCrashNorGiveInvalidRadiance) {
    const TemporaryFolder folder;
    for (const char* name : {"a.hdr", "a.exr"}) {
        write_environment(testing::noise_map(32, 2), folder / name);
        const std::string whole = load(folder / name);
        Random random(3);
        for (int k = 0; k < 300; ++k) {
            std::string bytes = whole;
            for (int hit = 0; hit < 3; ++hit)
                bytes[std::size_t(random.next() * double(bytes.size()))] = char(random.next_u64() & 255);
            save(folder / name, bytes);
            Progress progress;
            try {
                for (const Vec3f& p : read_environment(folder / name, {}, progress).pixels)
                    ASSERT_TRUE(is_finite(p) && p.x >= 0 && p.y >= 0 && p.z >= 0);
            } catch (const Error& e) {
                EXPECT_NE(e.kind(), ErrorKind::internal) << e.what();
            }
        }
    }
}

TEST(HostileImage, WhatIsNoEnvironmentMapIsRefusedWithTheReason) {
    const TemporaryFolder folder;
    save(folder / "text.hdr", "this is not an image");
    EXPECT_NE(refusal(folder / "text.hdr").find("no known image"), std::string::npos);
    save(folder / "empty.exr", "");
    EXPECT_NE(refusal(folder / "empty.exr"), "");
    EXPECT_NE(refusal(folder / "missing.exr").find("no such file"), std::string::npos);
    save(folder / "ascii.ppm", "P3\n2 1\n255\n0 0 0 1 1 1\n");
    EXPECT_NE(refusal(folder / "ascii.ppm").find("of the PNM family"), std::string::npos);

    const auto write = [&](const char* name, int width, int height, const auto& change) {
        OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::FLOAT);
        change(spec);
        const std::filesystem::path file = folder / name;
        const auto output = OIIO::ImageOutput::create(file.string());
        ASSERT_TRUE(output->open(file.string(), spec));
        const std::vector<float> values(std::size_t(width) * height * 3, 1.0f);
        ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()));
        output->close();
    };
    write("square.exr", 16, 16, [](OIIO::ImageSpec&) {});
    EXPECT_NE(refusal(folder / "square.exr").find("16 x 16 pixels, the shape of no layout; known are 2:1 (latlong)"),
              std::string::npos);
    write("turned.tif", 16, 8, [](OIIO::ImageSpec& s) { s.attribute("Orientation", 3); });
    EXPECT_NE(refusal(folder / "turned.tif").find("orientation is 3"), std::string::npos);
}

}  // namespace
}  // namespace hairbake
