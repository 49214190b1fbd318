// OpenEXR files as people have them.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace hairbake::exr_files_test
