#include "core/output/manifest.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/request/request_json.h"
#include "tests/core/output/small_result.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using Json = nlohmann::json;

const std::vector<WrittenFile> files{{"a.npy", "12ab", 99, {2, 3}, "two by three"}, {"b.json", "cd", 1, {}, "text"}};

TEST(Manifest, TellsOfHarmonicsConesAndTheReceiver) {
    BakeResult result = test_support::small_result();
    EXPECT_FALSE(Json::parse(make_manifest(result, files))["transmittance"].contains("receiver"));
    result.request.transmittance.sh_bands = 2;
    result.request.transmittance.bent_cone = true;
    result.inputs.digests["receiver"] = "ee";
    result.inputs.receiver = MeshFacts{.format = "OBJ", .positions = 2, .triangles = 1, .topology = {}};
    test_support::transmittance_of(result).arrays.push_back({&receiver_kind(), 2, {0.25f, 0.5f, 0.75f, 1}});
    const Json manifest = Json::parse(make_manifest(result, files));
    EXPECT_EQ(manifest["transmittance"]["sh_bands"], 2);
    EXPECT_EQ(manifest["transmittance"]["bent_cone"], true);
    EXPECT_EQ(manifest["transmittance"]["receiver"], Json({{"positions", 2}, {"mean", 0.5}, {"cosine_mean", 0.75}}));
    EXPECT_EQ(manifest["inputs"]["receiver"]["sha256"], "ee");
}

TEST(Manifest, HoldsTheRequestAsRunTheInputsAndTheFiles) {
    const BakeResult result = test_support::small_result();
    const Json manifest = Json::parse(make_manifest(result, files));
    EXPECT_EQ(manifest["request"], Json::parse(to_json(result.request)));
    EXPECT_EQ(manifest["id"], "0123456789abcdef");
    EXPECT_EQ(manifest["stages"]["transmittance"]["key"], "bb");
    EXPECT_EQ(manifest["stages"]["irradiance"]["key"], "dd");
    EXPECT_EQ(manifest["inputs"]["hair"]["sha256"], "aa");
    EXPECT_EQ(manifest["inputs"]["hair"]["vertices"], 5);
    EXPECT_EQ(manifest["inputs"]["environment"]["sha256"], "cc");
    EXPECT_EQ(manifest["repairs"]["hair"]["degenerate_segments"], 1);
    EXPECT_EQ(manifest["repairs"]["environment"]["negative_pixels"], 3);
    EXPECT_EQ(manifest["warnings"], Json({"a warning with \"quotes\""}));
    EXPECT_EQ(
        manifest["files"][0],
        Json({{"name", "a.npy"}, {"sha256", "12ab"}, {"bytes", 99}, {"shape", {2, 3}}, {"content", "two by three"}}));
    for (const char* library : {"hairbake", "openvdb", "embree", "openimageio"})
        EXPECT_TRUE(manifest["versions"].contains(library)) << library;
    EXPECT_FALSE(manifest["conventions"].empty());
}

TEST(Manifest, HasTheErrorBarTheTimingsAndTheMemoryOnTop) {
    BakeResult result = test_support::small_result();
    result.measured.timings_s["transmittance"] = 0.5;
    result.measured.peak_memory_bytes = 123;
    result.measured.threads = 7;
    const Json manifest = Json::parse(make_manifest(result, files));
    const Json& bar = manifest["error_bar"];
    EXPECT_EQ(bar["rmse"], 0.01);
    EXPECT_EQ(bar["bias"], -0.001);
    EXPECT_EQ(bar["ci95"]["rmse"], Json({0.008, 0.012}));
    EXPECT_EQ(bar["ci95"]["bias"], Json({-0.002, 0.0}));
    EXPECT_EQ(bar["noise"], 0.003);
    EXPECT_EQ(bar["vertices"], 4);
    EXPECT_EQ(bar["clear"]["rmse"], 0.02);
    EXPECT_EQ(bar["clear"]["vertices"], 2);
    EXPECT_EQ(bar["inside_strand"], 1);
    EXPECT_EQ(manifest["timings_s"], Json({{"transmittance", 0.5}}));
    EXPECT_EQ(manifest["peak_memory_bytes"], 123);
    EXPECT_EQ(manifest["measured"]["threads"], 7);
    EXPECT_EQ(manifest["measured"]["rays_per_second"], 5 * 100 / 0.5);  // vertices * directions / seconds
}

TEST(Manifest, AnErrorBarWithoutAVertexHasNoErrorRatherThanNone) {
    // Every vertex drawn lay inside another strand.
    BakeResult result = test_support::small_result();
    ErrorBar& bar_of_result = test_support::error_bar_of(result) = ErrorBar{};
    bar_of_result.inside_strand = 5;
    bar_of_result.directions = 4096;
    const Json bar = Json::parse(make_manifest(result, files))["error_bar"];
    EXPECT_EQ(bar, Json::parse(R"({"rmse": null, "bias": null, "ci95": {"rmse": null, "bias": null}, "noise": null,
                                   "vertices": 0, "inside_strand": 5, "directions": 4096,
                                   "clear": {"rmse": null, "bias": null, "ci95": {"rmse": null, "bias": null},
                                             "noise": null, "vertices": 0}})"));
}

TEST(Manifest, LeavesOutAStageThatDidNotRun) {
    BakeResult result = test_support::small_result();
    result.parts.erase(result.parts.begin());
    result.inputs.hair.reset();
    const Json manifest = Json::parse(make_manifest(result, files));
    EXPECT_TRUE(manifest["error_bar"].is_null());
    EXPECT_FALSE(manifest.contains("transmittance"));
    EXPECT_FALSE(manifest["stages"].contains("transmittance"));
    EXPECT_FALSE(manifest["inputs"].contains("hair"));
}

TEST(Manifest, ListsItsFilesAndNothingElseIsTakenForOne) {
    const test_support::TemporaryFolder folder;
    write_manifest(test_support::small_result(), files, folder / "");
    EXPECT_EQ(files_of_result(folder / ""), (std::vector<std::string>{"a.npy", "b.json"}));
    for (const char* text : {"", "{}", "[]", "3", R"({"format": "other", "files": []})",
                             R"({"format": "hairbake result", "files": [{}]})"}) {
        std::ofstream(folder / "manifest.json") << text;
        EXPECT_THROW(files_of_result(folder / ""), Error) << text;
    }
}

TEST(Manifest, OneThatIsNestedDeeplyOrEndlessIsRefusedUnread) {
    const test_support::TemporaryFolder folder;
    const auto refusal = [&] {
        try {
            files_of_result(folder / "");
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input);
            return std::string(error.what());
        }
        return std::string("was accepted");
    };
    const std::string name = (folder / "manifest.json").string();
    std::ofstream(name) << R"({"format": "hairbake result", "files": [], "stages": )" << std::string(500'000, '[')
                        << std::string(500'000, ']') << "}";
    EXPECT_EQ(refusal(), name + " is nested deeper than 64 levels");
    std::ofstream(name) << "{}" << std::string(16 << 20, ' ');
    EXPECT_EQ(refusal(), name + " is longer than a manifest may be (16 MiB)");
}

}  // namespace
}  // namespace hairbake
