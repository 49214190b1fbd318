#include "core/tools/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
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
    const Json report = Json::parse(compare(folder / "a", folder / "a").json);
    EXPECT_EQ(report["same"], true);
    EXPECT_EQ(report["transmittance"]["max_abs"], 0);
    EXPECT_EQ(report["specular_02"]["rms"], 0);
    EXPECT_TRUE(as_table(report.dump()).starts_with("equal: "));
}

TEST(Compare, GivesTheLargestTheRmsAndTheMeanDifference) {
    const TemporaryFolder folder;
    BakeResult a = small_result(), b = small_result();
    b.parts[0].arrays[0].values = {0.5f, 0.25f, 0.5f, 0.5f, 1};  // differences 0.5, 0, 0, -0.25, 0
    test_support::irradiance_of(b).maps->lobes[1].cubes[1][0].y += 3;
    write_npy_result(a, folder / "a");
    write_npy_result(b, folder / "b");
    const Json report = Json::parse(compare(folder / "a", folder / "b").json);
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

// Relatives: the tolerance of each map by itself, a NaN, an array that only one has.
TEST(Compare, ATolerancePassesSmallDifferencesOfEveryArray) {
    const TemporaryFolder folder;
    BakeResult b = small_result();
    b.parts[0].arrays[0].values[1] += 0.01f;
    write_npy_result(small_result(), folder / "a");
    write_npy_result(b, folder / "b");
    const Json report = Json::parse(compare(folder / "a", folder / "b").json);
    const double share = report["transmittance"]["max_over_largest"];
    EXPECT_NEAR(share, 0.01 / report["transmittance"]["largest"].get<double>(), 1e-6);
    EXPECT_FALSE(compare(folder / "a", folder / "b").equal);
    EXPECT_TRUE(compare(folder / "a", folder / "b", 1.01 * share).equal);
    EXPECT_FALSE(compare(folder / "a", folder / "b", 0.99 * share).equal);
    test_support::irradiance_of(b).maps->lobes[1].cubes[1][0].y += 1e6f;
    write_npy_result(b, folder / "c");
    EXPECT_FALSE(compare(folder / "a", folder / "c", 1.01 * share).equal);
    b = small_result();
    b.parts[0].arrays[0].values[1] = std::nanf("");
    write_npy_result(b, folder / "nan");
    EXPECT_FALSE(compare(folder / "a", folder / "nan", 1).equal);
    b = small_result();
    b.parts.pop_back();
    write_npy_result(b, folder / "fewer");
    EXPECT_FALSE(compare(folder / "a", folder / "fewer", 1).equal);
}

TEST(Compare, ANanIsNeverMasked) {
    const TemporaryFolder folder;
    BakeResult b = small_result();
    b.parts[0].arrays[0].values[1] = std::nanf("");
    write_npy_result(small_result(), folder / "a");
    write_npy_result(b, folder / "b");
    const Json report = Json::parse(compare(folder / "a", folder / "b").json);
    EXPECT_EQ(report["same"], false);
    for (const char* name : {"max_abs", "rms", "bias"}) EXPECT_TRUE(report["transmittance"][name].is_null()) << name;
}

/// A result with every array that a bake writes.
BakeResult full_result() {
    using test_support::counted_array;
    BakeResult result = small_result();
    std::vector<VertexArray>& arrays = result.parts[0].arrays;
    arrays.push_back(counted_array(transmittance_sh_kind(), 5, 4, 0.5f));
    arrays.push_back(counted_array(bent_cone_kind(), 5, 4, 0.25f));
    arrays.push_back(counted_array(effective_transmittance_kind(), 5, 6, 0.0625f));
    arrays.push_back(counted_array(receiver_kind(), 2, 2, 0.125f));
    return result;
}

TEST(Compare, SeesADifferenceInAnyOneArray) {
    const TemporaryFolder folder;
    write_npy_result(full_result(), folder / "a");
    struct Change {
        std::string entry;
        std::function<void(BakeResult&)> make;
    };
    std::vector<Change> changes{
        {"diffuse", [](BakeResult& r) { r.parts[1].maps->lobes[0].cubes[0][0].x += 0.25f; }},
        {"specular_02", [](BakeResult& r) { r.parts[1].maps->lobes[1].cubes[2][5].z += 0.25f; }},
    };
    for (std::size_t k = 0; k < full_result().parts[0].arrays.size(); ++k) {
        const std::string name(full_result().parts[0].arrays[k].kind->name);
        changes.push_back({name, [k](BakeResult& r) { r.parts[0].arrays[k].values.back() += 0.25f; }});
    }
    ASSERT_EQ(changes.size(), 2 + array_kinds().size());
    for (const Change& change : changes) {
        SCOPED_TRACE(change.entry);
        BakeResult other = full_result();
        change.make(other);
        write_npy_result(other, folder / "b");
        const Json report = Json::parse(compare(folder / "a", folder / "b").json);
        EXPECT_EQ(report["same"], false);
        EXPECT_NE(as_table(report.dump()).find(change.entry + " "), std::string::npos);
        for (const auto& [name, entry] : report.items())
            if (entry.is_object()) {
                EXPECT_EQ(entry["max_abs"], name == change.entry ? 0.25 : 0.0) << name;
            }
    }
    const Json same = Json::parse(compare(folder / "a", folder / "a").json);
    EXPECT_EQ(same["same"], true);
    EXPECT_EQ(same.size(), 5u + 5 + 1 + 3);  // first, second, tolerance, equal, same; arrays; diffuse; specular maps
}

TEST(Compare, AnArrayThatOnlyOneResultHasIsNamed) {
    const TemporaryFolder folder;
    BakeResult without = small_result();
    without.parts.pop_back();  // the irradiance
    write_npy_result(without, folder / "a");
    write_npy_result(small_result(), folder / "b");
    const Json report = Json::parse(compare(folder / "a", folder / "b").json);
    EXPECT_EQ(report["diffuse"], "only in the second");
    EXPECT_EQ(report["specular"], "only in the second");
    EXPECT_EQ(report["same"], false);
}

TEST(Compare, AManifestCannotNameFilesOutsideItsFolder) {
    const TemporaryFolder folder;
    write_npy_result(small_result(), folder / "a");
    write_npy_result(small_result(), folder / "b");
    std::string manifest = read_manifest_text(folder / "b" / "manifest.json");
    manifest.replace(manifest.find("diffuse.npy"), 11, "../d.npy");
    std::ofstream(folder / "b" / "manifest.json") << manifest;
    try {
        compare(folder / "a", folder / "b").json;
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        EXPECT_NE(std::string(error.what()).find("../d.npy"), std::string::npos) << error.what();
    }
}

TEST(Compare, NamesWhatCannotBeCompared) {
    const TemporaryFolder folder;
    BakeResult b = small_result();
    b.parts.erase(b.parts.begin());
    test_support::irradiance_of(b).maps->lobes[1].cubes.pop_back();
    write_npy_result(small_result(), folder / "a");
    write_npy_result(b, folder / "b");
    const Json report = Json::parse(compare(folder / "a", folder / "b").json);
    EXPECT_EQ(report["transmittance"], "only in the first");
    EXPECT_EQ(report["specular"], "shapes [3, 6, 4, 4, 3] and [2, 6, 4, 4, 3] cannot be compared");
    EXPECT_EQ(report["same"], false);
    EXPECT_THROW(compare(folder / "a", folder / "missing").json, Error);
}

}  // namespace
}  // namespace hairbake
