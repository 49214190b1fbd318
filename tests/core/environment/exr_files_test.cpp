// OpenEXR files as people have them.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "core/environment/color_primaries.h"
#include "tests/core/environment/picture_files.h"
#include "tests/support/make_map.h"
#include "tests/support/temporary_folder.h"

namespace hairbake::exr_files_test {
namespace {

using namespace picture_files;
using test_support::TemporaryFolder;
using testing::noise_map;

constexpr int width = 16, height = 8;

TEST(ExrFiles, ADataWindowInsideOrBeyondTheDisplayWindowIsPlaced) {
    const TemporaryFolder folder;
    for (const bool tiled : {false, true})
        for (const auto& [x, y, w, h] :
             {std::array{4, 2, 8, 6}, std::array{-3, -2, 24, 13}, std::array{5, -1, 20, 5}}) {
            std::vector<Vec3f> pixels;
            for (int row = 0; row < h; ++row)
                for (int column = 0; column < w; ++column)
                    pixels.push_back({float(x + column + 100), float(y + row + 100), 1});
            // The display window begins at (7, 9): only the offset between the windows counts.
            ExrHeader header{7 + x, 9 + y, 7, 9, width, height, tiled, {}, {}};
            write_exr(folder / "a.exr", w, h, pixels, header);
            const EnvironmentMap map = read_picture(folder / "a.exr");
            EXPECT_TRUE(warns(map, "data window"));
            ASSERT_EQ(map.width, width);
            for (int row = 0; row < height; ++row)
                for (int column = 0; column < width; ++column) {
                    const bool inside = column >= x && column < x + w && row >= y && row < y + h;
                    const Vec3f wanted = inside ? Vec3f{float(column + 100), float(row + 100), 1} : Vec3f();
                    ASSERT_EQ(map.pixels[std::size_t(row) * width + column], wanted) << column << ' ' << row;
                }
        }
}

TEST(ExrFiles, WindowsThatHardlyMeetAreRefusedBeforeMemoryIsTaken) {
    const TemporaryFolder folder;
    const std::vector<Vec3f> pixels(std::size_t(width) * height, Vec3f(1));
    const auto message = [&](const ExrHeader& header) {
        write_exr(folder / "a.exr", width, height, pixels, header);
        return picture_refusal(folder / "a.exr");
    };
    EXPECT_NE(message({0, 0, 0, 0, 16384, 8192, false, {}, {}}).find("less than an eighth"), std::string::npos);
    EXPECT_NE(message({100, 0, 0, 0, 16, 8, false, {}, {}}), "");
    EXPECT_NE(message({0, 0, 0, 0, 4, 2, false, {}, {}}), "") << "a sixteenth of the data is used";
}

TEST(ExrFiles, LatLongAutoFollowsTheEnvmapAttribute) {
    const TemporaryFolder folder;
    const std::vector<Vec3f> pixels(std::size_t(width) * height, Vec3f(1));
    ExrHeader says;
    says.texture = "LatLong Environment";
    write_exr(folder / "says.exr", width, height, pixels, says);
    write_exr(folder / "silent.exr", width, height, pixels);
    EXPECT_EQ(read_picture(folder / "says.exr").latlong, LatLong::openexr);
    EXPECT_EQ(read_picture(folder / "silent.exr").latlong, LatLong::gltf);
    EnvironmentSettings settings;
    settings.latlong = LatLong::filament;
    EXPECT_EQ(read_picture(folder / "says.exr", settings).latlong, LatLong::filament);
}

TEST(ExrFiles, TheBeautyIsFoundInAnyPartAndOfAMipMapTheFirstLevel) {
    const TemporaryFolder folder;
    const EnvironmentMap map = noise_map(width, 2);
    std::vector<OIIO::ImageSpec> specs(2, OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::FLOAT));
    specs[0] = OIIO::ImageSpec(4, 4, 1, OIIO::TypeDesc::FLOAT);  // a part of another size
    specs[0].full_width = width, specs[0].full_height = height;  // all parts share the display window
    specs[0].channelnames = {"Z"};
    specs[0].attribute("oiio:subimagename", "depth");
    specs[1].attribute("oiio:subimagename", "beauty");
    const std::string parts = (folder / "parts.exr").string(), mips = (folder / "mips.exr").string();
    auto output = OIIO::ImageOutput::create(parts);
    const std::vector<float> depth(16, 100.f);
    ASSERT_TRUE(output->open(parts, 2, specs.data())) << output->geterror();
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, depth.data())) << output->geterror();
    ASSERT_TRUE(output->open(parts, specs[1], OIIO::ImageOutput::AppendSubimage)) << output->geterror();
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, map.pixels.data())) << output->geterror();
    ASSERT_TRUE(output->close());
    const EnvironmentMap back = read_picture(parts);
    EXPECT_EQ(back.pixels, map.pixels);
    EXPECT_TRUE(warns(back, "taken is \"beauty\""));

    OIIO::ImageSpec level(width, height, 3, OIIO::TypeDesc::FLOAT);
    level.tile_width = level.tile_height = 16;
    level.attribute("textureformat", "Plain Texture");  // OpenImageIO then writes levels
    output = OIIO::ImageOutput::create(mips);
    ASSERT_TRUE(output->open(mips, level) && output->write_image(OIIO::TypeDesc::FLOAT, map.pixels.data()));
    for (int w = width / 2; w >= 1; w /= 2) {
        OIIO::ImageSpec next(w, std::max(1, w / 2), 3, OIIO::TypeDesc::FLOAT);
        next.tile_width = next.tile_height = 16;
        const std::vector<float> black(std::size_t(3) * w * w);
        ASSERT_TRUE(output->open(mips, next, OIIO::ImageOutput::AppendMIPLevel)) << output->geterror();
        ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, black.data()));
    }
    ASSERT_TRUE(output->close());
    output.reset();  // OpenEXR keeps the end of the file until its writer is gone
    EXPECT_EQ(read_picture(mips).pixels, map.pixels);
}

/// A picture of smooth colours, as OpenEXR writes it: luminance and chroma, the chroma in a quarter of the pixels.
void write_subsampled(const std::filesystem::path& file, int w, int h, const std::vector<Vec3f>& pixels,
                      Imf::RgbaChannels channels) {
    std::vector<Imf::Rgba> rgba;
    for (const Vec3f& p : pixels) rgba.emplace_back(p.x, p.y, p.z);
    Imf::RgbaOutputFile out(file.string().c_str(), w, h, channels);
    out.setYCRounding(10, 10);  // bits of the mantissa: all that a half float has
    out.setFrameBuffer(rgba.data(), 1, static_cast<std::size_t>(w));
    out.writePixels(h);
}

std::vector<Vec3f> smooth_picture(int w, int h) {
    std::vector<Vec3f> pixels;
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
            pixels.emplace_back(1 + 0.01f * float(x), 2 - 0.005f * float(x) + 0.01f * float(y),
                                0.5f + 0.01f * float(y));
    return pixels;
}

// Relatives: luminance alone; chroma of full size, which OpenImageIO reads; other channels in fewer pixels.
TEST(ExrFiles, LuminanceAndChromaAreRead) {
    const TemporaryFolder folder;
    constexpr int w = 64, h = 32;
    const std::vector<Vec3f> pixels = smooth_picture(w, h);
    write_subsampled(folder / "yc.exr", w, h, pixels, Imf::WRITE_YC);
    write_subsampled(folder / "y.exr", w, h, pixels, Imf::WRITE_Y);
    const EnvironmentMap yc = read_picture(folder / "yc.exr"), y = read_picture(folder / "y.exr");
    ASSERT_EQ(yc.width, w);
    const Vec3d weights = luminance_weights(default_chromaticities());
    for (int row = 0; row < h; ++row)
        for (int x = 0; x < w; ++x) {
            const std::size_t i = std::size_t(row) * w + x;
            const double luminance = dot(Vec3d(pixels[i]), weights);
            EXPECT_NEAR(dot(Vec3d(yc.pixels[i]), weights), luminance, 0.005 * luminance);  // ten bits of half floats
            EXPECT_NEAR(y.pixels[i].x, luminance, 0.002 * luminance);
            // At the borders the interpolation repeats the last chroma.
            for (const int c : {0, 1, 2})
                if (x > 14 && x < w - 14 && row > 14 && row < h - 14) {
                    EXPECT_NEAR(yc.pixels[i][c], pixels[i][c], 0.005 * luminance);  // green takes all errors
                }
        }
    // Chroma of full size: R = (RY + 1) Y and so on.
    OIIO::ImageSpec spec(w, h, 3, OIIO::TypeDesc::FLOAT);
    spec.channelnames = {"BY", "RY", "Y"};
    std::vector<float> values;
    for (const Vec3f& p : pixels) {
        const double luminance = dot(Vec3d(p), weights);
        for (const double v : {(p.z - luminance) / luminance, (p.x - luminance) / luminance, luminance})
            values.push_back(static_cast<float>(v));
    }
    const auto out = OIIO::ImageOutput::create("openexr");
    ASSERT_TRUE(out->open((folder / "full.exr").string(), spec) &&
                out->write_image(OIIO::TypeDesc::FLOAT, values.data()));
    out->close();
    const EnvironmentMap full = read_picture(folder / "full.exr");
    for (std::size_t i = 0; i < pixels.size(); ++i)
        for (const int c : {0, 1, 2}) EXPECT_NEAR(full.pixels[i][c], pixels[i][c], 1e-5);
    // Only half a file.
    std::filesystem::resize_file(folder / "yc.exr", std::filesystem::file_size(folder / "yc.exr") / 2);
    EXPECT_NE(picture_refusal(folder / "yc.exr").find("yc.exr"), std::string::npos);
}

TEST(ExrFiles, OtherChannelsInFewerPixelsAreRefusedWithTheReason) {
    const TemporaryFolder folder;
    Imf::Header header(16, 8);
    header.channels().insert("R", Imf::Channel(Imf::HALF, 2, 2));
    header.channels().insert("G", Imf::Channel(Imf::HALF));
    header.channels().insert("B", Imf::Channel(Imf::HALF, 2, 2));
    {
        Imf::OutputFile out((folder / "rgb.exr").string().c_str(), header);
        std::vector<half> zeros(16 * 8, half(1.0f));
        Imf::FrameBuffer buffer;
        for (const char* name : {"R", "B"})
            buffer.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(zeros.data()), 2, 16, 2, 2));
        buffer.insert("G", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(zeros.data()), 2, 32));
        out.setFrameBuffer(buffer);
        out.writePixels(8);
    }
    EXPECT_NE(picture_refusal(folder / "rgb.exr").find("fewer pixels"), std::string::npos)
        << picture_refusal(folder / "rgb.exr");
}

}  // namespace
}  // namespace hairbake::exr_files_test
