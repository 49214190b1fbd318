#include "core/tools/diff.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/output/picture_encoding.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using Json = nlohmann::json;
using test_support::TemporaryFolder;

class Diff : public testing::Test {
protected:
    std::string difference(const std::filesystem::path& a, const std::filesystem::path& b,
                           const std::optional<std::filesystem::path>& picture = {}, std::optional<double> scale = {}) {
        Progress progress;
        return diff(a, b, picture, scale, progress);
    }
    std::filesystem::path write(const std::string& name, const std::vector<Vec3f>& pixels, int width) {
        const auto bytes = encode_exr(pixels, width, static_cast<int>(pixels.size()) / width, {});
        std::ofstream(folder / name, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        return folder / name;
    }
    TemporaryFolder folder;
};

TEST_F(Diff, GivesRmseMaximumAndBiasOverAllAndOverLitPixels) {
    // Four pixels, twelve values; differences 1, -2 and 0.5, the rest 0; two pixels are black in both.
    const auto a = write("a.exr", {{1, 1, 1}, {2, 0, 0}, {}, {}}, 2);
    const auto b = write("b.exr", {{2, 1, 1}, {0, 0, 0.5f}, {}, {}}, 2);
    const Json report = Json::parse(difference(a, b));
    EXPECT_EQ(report["width"], 2);
    EXPECT_DOUBLE_EQ(report["rmse"], std::sqrt(5.25 / 12));
    EXPECT_EQ(report["max_abs"], 2);
    EXPECT_DOUBLE_EQ(report["bias"], -0.5 / 12);
    EXPECT_DOUBLE_EQ(report["mean"], 5.0 / 12);
    EXPECT_EQ(report["lit"]["pixels"], 2);
    EXPECT_DOUBLE_EQ(report["lit"]["rmse"], std::sqrt(5.25 / 6));
    EXPECT_DOUBLE_EQ(report["lit"]["rmse_over_mean"], std::sqrt(5.25 / 6) / (5.0 / 6));
    EXPECT_NE(diff_as_lines(report.dump()).find("maximum         2"), std::string::npos);
    EXPECT_EQ(Json::parse(difference(a, a))["rmse"], 0);
}

TEST_F(Diff, DrawsFalseColoursOnAScaleThatIsRoundedUp) {
    std::vector<Vec3f> black(96 * 4), lit = black;
    lit[5] = {0, 0.13f, 0};  // half of 0.2 would be less: the scale is 1, 2 or 5 times a power of ten
    const auto a = write("a.exr", black, 96), b = write("b.exr", lit, 96);
    EXPECT_DOUBLE_EQ(Json::parse(difference(a, b, folder / "d.png", {}))["scale"], 0.2);
    EXPECT_DOUBLE_EQ(Json::parse(difference(a, b, folder / "d.png", 0.13))["scale"], 0.13);
    // At the end of the scale white, at nothing black.
    const auto pixels = test_support::run_program("oiiotool --dumpdata " + (folder / "d.png").string());
    EXPECT_NE(pixels.output.find("Pixel (5, 0): 255 255 255"), std::string::npos) << pixels.output.substr(0, 400);
    EXPECT_NE(pixels.output.find("Pixel (4, 0): 0 0 0"), std::string::npos);
    EXPECT_THROW(difference(a, b, folder / "d.jpg", {}), Error);
    EXPECT_THROW(difference(a, b, folder / "d.png", -1), Error);
}

TEST_F(Diff, NeverMasksANan) {
    const auto a = write("a.exr", {{1, 1, 1}, {2, 0, 0}}, 2), b = write("b.exr", {{1, std::nanf(""), 1}, {5, 0, 0}}, 2);
    const Json report = Json::parse(difference(a, b));
    for (const char* name : {"rmse", "max_abs", "bias"}) EXPECT_TRUE(report[name].is_null()) << name;
}

TEST_F(Diff, RefusesPicturesOfOtherSizesAndWhatIsNone) {
    const auto a = write("a.exr", {{1, 1, 1}, {2, 0, 0}}, 2), b = write("b.exr", {{1, 1, 1}, {2, 0, 0}}, 1);
    std::ofstream(folder / "text.exr") << "no picture";
    std::filesystem::copy(a, folder / "short.exr");
    std::filesystem::resize_file(folder / "short.exr", std::filesystem::file_size(a) - 8);
    for (const auto& other : {b, folder / "text.exr", folder / "short.exr", folder / "missing.exr"}) {
        try {
            difference(a, other);
            ADD_FAILURE() << other;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input);
            EXPECT_NE(std::string(error.what()).find(other.filename().string()), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace hairbake
