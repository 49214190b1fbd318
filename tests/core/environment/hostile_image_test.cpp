#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdint>
#include <fstream>

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

long peak_kilobytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

std::string little(std::uint32_t v) {
    return {char(v & 255), char(v >> 8 & 255), char(v >> 16 & 255), char(v >> 24 & 255)};
}
std::string big(std::uint32_t v) {
    return {char(v >> 24 & 255), char(v >> 16 & 255), char(v >> 8 & 255), char(v & 255)};
}

// A complete OpenEXR header (three half channels, ZIP) declaring any size, and next to no pixels.
std::string exr_header(std::uint32_t width, std::uint32_t height) {
    const auto attribute = [](const std::string& name, const std::string& type, const std::string& value) {
        return name + '\0' + type + '\0' + little(std::uint32_t(value.size())) + value;
    };
    std::string channels;
    for (const char* c : {"B", "G", "R"})
        channels += std::string(c) + '\0' + little(1) + little(0) + little(1) + little(1);
    const std::string window = little(0) + little(0) + little(width - 1) + little(height - 1), one = little(0x3f800000);
    return little(20000630) + little(2) + attribute("channels", "chlist", channels + '\0') +
           attribute("compression", "compression", "\3") + attribute("dataWindow", "box2i", window) +
           attribute("displayWindow", "box2i", window) + attribute("lineOrder", "lineOrder", std::string(1, '\0')) +
           attribute("pixelAspectRatio", "float", one) + attribute("screenWindowCenter", "v2f", little(0) + little(0)) +
           attribute("screenWindowWidth", "float", one) + '\0' + std::string(64, '\0');
}

// A PNG whose first chunk declares any size (the checksum of the chunk computed as PNG's specification says).
std::string png_header(std::uint32_t width, std::uint32_t height) {
    const std::string chunk = "IHDR" + big(width) + big(height) + std::string{8, 2, 0, 0, 0};
    std::uint32_t crc = ~0u;
    for (const unsigned char byte : chunk) {
        crc ^= byte;
        for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
    }
    return "\x89PNG\r\n\x1a\n" + big(13) + chunk + big(~crc) + std::string(64, '\0');
}

std::string hdr_header(const std::string& resolution) {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + resolution + "\n\2\2" + std::string(2, '\0');
}

TEST(HostileImage, HugeDeclaredSizesAreRefusedBeforeMemoryIsTaken) {
    const TemporaryFolder folder;
    const long before = peak_kilobytes();
    save(folder / "a.exr", exr_header(1 << 20, 1 << 19));
    save(folder / "b.exr", exr_header(32768, 16384));
    save(folder / "a.png", png_header(1 << 20, 1 << 19));
    save(folder / "b.png", png_header(40000, 20000));
    save(folder / "a.hdr", hdr_header("-Y 1073741824 +X 2147483647"));
    save(folder / "b.hdr", hdr_header("-Y 8193 +X 16386"));
    save(folder / "c.hdr", hdr_header("-Y 8192 +X 16384"));  // allowed, but not in 60 bytes
    save(folder / "a.pfm", "PF\n16384 8192\n-1.0\n1234");
    for (const char* name : {"a.exr", "b.exr", "a.png", "b.png", "a.hdr", "b.hdr", "c.hdr", "a.pfm"})
        EXPECT_NE(refusal(folder / name), "") << name;
    EXPECT_NE(refusal(folder / "b.hdr").find("16386 x 8193 pixels; allowed is up to 16384 x 8192"), std::string::npos);
    EXPECT_NE(refusal(folder / "c.hdr").find("cannot hold them"), std::string::npos);
    // The smallest of them would be 800 MB of pixels; the readers' own buffers stay far below 100 MB.
    EXPECT_LT(peak_kilobytes() - before, 100'000);
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
    EXPECT_NE(refusal(folder / "ascii.ppm").find("no known image"), std::string::npos);

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
    write("window.exr", 16, 8, [](OIIO::ImageSpec& s) { s.full_width = 32; });
    EXPECT_NE(refusal(folder / "window.exr").find("display window"), std::string::npos);
    write("turned.tif", 16, 8, [](OIIO::ImageSpec& s) { s.attribute("Orientation", 3); });
    EXPECT_NE(refusal(folder / "turned.tif").find("orientation is 3"), std::string::npos);
}

}  // namespace
}  // namespace hairbake
