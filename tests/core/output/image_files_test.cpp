// The EXR, PNG and SH files, read back by OpenImageIO's own tool and by Python.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/output/latlong_picture.h"
#include "core/output/map_files.h"
#include "core/output/preview.h"
#include "tests/core/output/small_result.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using test_support::run_program;
using test_support::small_result;
using test_support::TemporaryFolder;

std::string oiiotool_info(const std::filesystem::path& file) {
    return run_program("oiiotool --info -v " + file.string() + " 2>&1").output;
}

/// One pixel as oiiotool prints it: "Pixel (3, 6): 2027.000000000 2027.250000000 1973.000000000".
std::string oiiotool_pixel(const std::filesystem::path& file, int x, int y) {
    const std::string place = "Pixel (" + std::to_string(x) + ", " + std::to_string(y) + "):";
    return run_program("oiiotool --dumpdata " + file.string() + " 2>&1 | grep -F '" + place + "'").output;
}

bool contains(const std::string& text, const std::string& piece) { return text.find(piece) != std::string::npos; }

TEST(MapExr, OiiotoolFindsTheFacesInAVerticalStripWithTheirMetadata) {
    const TemporaryFolder folder;
    BakeProgress progress;
    const auto files = write_map_exr(*small_result().parts[1].maps, {}, folder / "", progress);
    EXPECT_EQ(files.size(), 8u);  // (diffuse + three specular) x (strip + lat-long)
    const std::string info = oiiotool_info(folder / "specular_01.exr");
    for (const char* piece : {"4 x   24, 3 channel, float openexr", "hairbake:faceOrder: \"+X -X +Y -Y +Z -Z\"",
                              "hairbake:thetaPrimeDeg: \"90\"", "hairbake:exponent: \"64\"", "hairbake:units"})
        EXPECT_TRUE(contains(info, piece)) << piece << " is not in\n" << info;
    // Face -X is the second: its row 2, column 3 is texel (1 * 4 + 2) * 4 + 3 = 27 and lies at y = 4 + 2.
    const std::string pixel = oiiotool_pixel(folder / "specular_01.exr", 3, 6);
    EXPECT_TRUE(contains(pixel, "2027") && contains(pixel, "2027.25") && contains(pixel, "1973")) << pixel;
}

TEST(MapExr, SaysThePrimariesOfItsColours) {
    const TemporaryFolder folder;
    BakeProgress progress;
    const Chromaticities xy{.7f, .3f, .2f, .75f, .15f, .05f, .3127f, .329f};
    write_map_exr(*small_result().parts[1].maps, {name_of(xy), xy}, folder / "", progress);
    for (const char* name : {"diffuse.exr", "specular_01_latlong.exr"}) {
        const std::string info = oiiotool_info(folder / name);
        EXPECT_TRUE(contains(info, "chromaticities: 0.7, 0.3, 0.2, 0.75, 0.15, 0.05, 0.3127, 0.329")) << info;
        EXPECT_TRUE(contains(info, "hairbake:primaries: \"custom: red 0.7 0.3")) << info;
    }
    std::filesystem::create_directory(folder / "unknown");
    write_map_exr(*small_result().parts[1].maps, {}, folder / "unknown", progress);
    const std::string info = oiiotool_info(folder / "unknown" / "diffuse.exr");
    EXPECT_FALSE(contains(info, "chromaticities")) << info;
    EXPECT_TRUE(contains(info, "hairbake:primaries: \"unspecified\"")) << info;
}

TEST(MapExr, HoldsNeitherDateNorPath) {
    const TemporaryFolder folder;
    BakeProgress progress;
    write_map_exr(*small_result().parts[1].maps, {}, folder / "", progress);
    for (const char* name : {"diffuse.exr", "diffuse_latlong.exr"}) {
        const auto found =
            run_program("grep -a -c -E '20[0-9][0-9]:[0-9][0-9]|hairbake-test-' " + (folder / name).string());
        EXPECT_EQ(found.output, "0\n") << name;
    }
}

TEST(MapExr, NamesHaveAsManyDigitsAsTheLastMapNeeds) {
    const TemporaryFolder folder;
    BakeProgress progress;
    MapSet maps = *small_result().parts[1].maps;
    maps.lobes[1].cubes.resize(102, maps.lobes[0].cubes[0]);
    maps.lobes[1].theta_prime_deg.resize(102);
    write_map_exr(maps, {}, folder / "", progress);
    EXPECT_TRUE(std::filesystem::exists(folder / "specular_001.exr"));
    EXPECT_TRUE(std::filesystem::exists(folder / "specular_101_latlong.exr"));
}

TEST(LatLongPicture, LooksAlongTheAxesWhereTheGltfConventionSays) {
    // Each face in a colour of its own: the centre of the picture is +X, a quarter to the right +Z, the edges -X, a
    // quarter to the left -Z, the top +Y, the bottom -Y.
    CubeTexels cube;
    for (int face = 0; face < 6; ++face) cube.insert(cube.end(), 16, Vec3f(float(face)));
    const Picture picture = to_latlong(cube, 4, 64);
    ASSERT_EQ(picture.height, 32);
    const auto at = [&](int x, int y) { return picture.pixels[std::size_t(y) * 64 + x].x; };
    EXPECT_EQ(at(32, 16), 0);  // +X
    EXPECT_EQ(at(0, 16), 1);   // -X
    EXPECT_EQ(at(32, 0), 2);   // +Y
    EXPECT_EQ(at(32, 31), 3);  // -Y
    EXPECT_EQ(at(48, 16), 4);  // +Z
    EXPECT_EQ(at(16, 16), 5);  // -Z
}

TEST(EnvironmentSh, PythonReadsTheCoefficientsToTheLastBit) {
    const TemporaryFolder folder;
    write_environment_sh(std::get<IrradianceFacts>(small_result().parts[1].facts), {"Rec.2020", {}}, folder / "");
    const auto python = test_support::run_python(
        "import json, sys; m = json.load(open(sys.argv[1]))\n"
        "assert m['bands'] == 2 and m['primaries'] == 'Rec.2020' and m['coefficients'] == [[1, 2, 3], [.1, .2, .3], "
        "[1e-20, 0, -5], [7, 8, 9]]\n"
        "print('read')",
        (folder / "environment_sh.json").string());
    EXPECT_EQ(python.output, "read\n");
}

class Preview : public testing::TestWithParam<int> {};

TEST_P(Preview, IsAPngThatOiiotoolReadsAndHasSomethingOnIt) {
    // Bit 0: with hair, bit 1: with an environment.
    const TemporaryFolder folder;
    BakeResult result = small_result();
    if (!(GetParam() & 2)) {
        result.parts.pop_back();
        result.inputs.environment.reset();
    }
    if (!(GetParam() & 1)) {
        result.parts.erase(result.parts.begin());
        result.hair.reset();
    }
    std::vector<std::string> warnings;
    const WrittenFile file = write_preview(result, folder / "", warnings);
    EXPECT_TRUE(warnings.empty());
    EXPECT_TRUE(contains(oiiotool_info(folder / "preview.png"), "3 channel, uint8 png"));
    EXPECT_EQ(file.shape.at(1), 1600u);
    const std::string statistics = run_program("oiiotool --stats " + (folder / "preview.png").string()).output;
    EXPECT_TRUE(contains(statistics, "Stats Max: 2")) << statistics;  // text of 232 to 240
}

INSTANTIATE_TEST_SUITE_P(Sheets, Preview, testing::Values(1, 2, 3));

TEST(PreviewSheet, ShowsAtMost36OfManyMapsAndSurvivesBlackAndEmptyResults) {
    const TemporaryFolder folder;
    BakeResult result = small_result();
    MapSet& maps = *test_support::irradiance_of(result).maps;
    maps.lobes[0].cubes[0].assign(96, {});
    maps.lobes[1].cubes.assign(257, CubeTexels(96));
    maps.lobes[1].theta_prime_deg.assign(257, 0);
    result.hair = HairModel{};
    result.hair->strand_begin = {0};
    test_support::transmittance_of(result).arrays[0].values.clear();
    test_support::error_bar_of(result).outside.vertices = 0;
    std::vector<std::string> warnings;
    const WrittenFile file = write_preview(result, folder / "", warnings);
    EXPECT_LT(file.shape.at(0), 2200u);
}

}  // namespace
}  // namespace hairbake
