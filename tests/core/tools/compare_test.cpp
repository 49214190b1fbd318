#include "core/tools/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/output/array_files.h"
#include "core/output/manifest.h"
#include "core/output/result_folder.h"
#include "tests/core/output/small_result.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using Json = nlohmann::json;
using test_support::small_result;
using test_support::TemporaryFolder;

void write_npy_result(const BakeResult& result, const std::filesystem::path& folder) {
    ResultFolder target(folder);
    std::vector<WrittenFile> files;
    for (const StagePart& part : result.parts) {
        for (const VertexArray& array : part.arrays) files.push_back(write_array_npy(array, target.path()));
        if (part.maps)
            for (const WrittenFile& file : write_map_npy(*part.maps, target.path())) files.push_back(file);
    }
    write_manifest(result, files, target.path());
    target.commit();
}

TEST(Compare, AResultEqualsItself) {
    const TemporaryFolder folder;
    write_npy_result(small_result(), folder / "a");
    const Json report = Json::parse(compare(folder / "a", folder / "a"));
    EXPECT_EQ(report["same"], true);
    EXPECT_EQ(report["transmittance"]["max_abs"], 0);
    EXPECT_EQ(report["specular_02"]["rms"], 0);
    EXPECT_NE(as_table(report.dump()).find("all values are equal"), std::string::npos);
}

TEST(Compare, GivesTheLargestTheRmsAndTheMeanDifference) {
    const TemporaryFolder folder;
    BakeResult a = small_result(), b = small_result();
    b.parts[0].arrays[0].values = {0.5f, 0.25f, 0.5f, 0.5f, 1};  // differences 0.5, 0, 0, -0.25, 0
    test_support::irradiance_of(b).maps->lobes[1].cubes[1][0].y += 3;
    write_npy_result(a, folder / "a");
    write_npy_result(b, folder / "b");
    const Json report = Json::parse(compare(folder / "a", folder / "b"));
    EXPECT_EQ(report["same"], false);
    const Json& t = report["transmittance"];
    EXPECT_EQ(t["values"], 5);
    EXPECT_EQ(t["max_abs"], 0.5);
    EXPECT_DOUBLE_EQ(t["rms"], std::sqrt((0.25 + 0.0625) / 5));
    EXPECT_DOUBLE_EQ(t["bias"], 0.25 / 5);
    EXPECT_EQ(t["largest"], 1);
    EXPECT_EQ(report["specular_00"]["max_abs"], 0);
    EXPECT_EQ(report["specular_01"]["max_abs"], 3);
    EXPECT_EQ(report["diffuse"]["max_abs"], 0);
}

TEST(Compare, ANanIsNeverMasked) {
    const TemporaryFolder folder;
    BakeResult b = small_result();
    b.parts[0].arrays[0].values[1] = std::nanf("");
    write_npy_result(small_result(), folder / "a");
    write_npy_result(b, folder / "b");
    const Json report = Json::parse(compare(folder / "a", folder / "b"));
    EXPECT_EQ(report["same"], false);
    for (const char* name : {"max_abs", "rms", "bias"}) EXPECT_TRUE(report["transmittance"][name].is_null()) << name;
}

TEST(Compare, NamesWhatCannotBeCompared) {
    const TemporaryFolder folder;
    BakeResult b = small_result();
    b.parts.erase(b.parts.begin());
    test_support::irradiance_of(b).maps->lobes[1].cubes.pop_back();
    write_npy_result(small_result(), folder / "a");
    write_npy_result(b, folder / "b");
    const Json report = Json::parse(compare(folder / "a", folder / "b"));
    EXPECT_EQ(report["transmittance"], "only in the first");
    EXPECT_EQ(report["specular"], "shapes [3, 6, 4, 4, 3] and [2, 6, 4, 4, 3] cannot be compared");
    EXPECT_EQ(report["same"], false);
    EXPECT_THROW(compare(folder / "a", folder / "missing"), Error);
}

}  // namespace
}  // namespace hairbake
