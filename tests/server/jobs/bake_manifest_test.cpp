#include "server/jobs/bake_manifest.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace hairbake {
namespace {

using Json = nlohmann::json;

const std::string transmittance =
    R"({"format": "hairbake result", "id": "t", "request": {}, "stages": {"transmittance": {"key": "k"}},
    "inputs": {"hair": 1}, "transmittance": {"mean": 0.5}, "error_bar": {"rmse": 0.1}, "repairs": {"hair": 0}, "warnings": ["a"],
    "files": [{"name": "transmittance.npy"}, {"name": "preview.png"}], "timings_s": {"read_hair": 1, "write": 2},
    "peak_memory_bytes": 10})";
const std::string irradiance =
    R"({"format": "hairbake result", "id": "i", "request": {}, "stages": {"irradiance": {"key": "l"}},
    "inputs": {"environment": 2}, "irradiance": {"exponent": 64}, "error_bar": null, "repairs": {"environment": 1},
    "warnings": ["b"], "files": [{"name": "preview.png"}], "timings_s": {"irradiance": 4, "write": 8}, "peak_memory_bytes": 30})";

TEST(BakeManifest, JoinsItsStages) {
    const Json whole = Json::parse(make_bake_manifest("id", R"({"hair": "sha256:x"})",
                                                      {{"transmittance", transmittance}, {"irradiance", irradiance}}));
    EXPECT_EQ(whole["id"], "id");
    EXPECT_EQ(whole["request"]["hair"], "sha256:x");
    EXPECT_EQ(whole["stages"], Json::parse(R"({"transmittance": {"key": "k"}, "irradiance": {"key": "l"}})"));
    EXPECT_EQ(whole["inputs"], Json::parse(R"({"hair": 1, "environment": 2})"));
    EXPECT_EQ(whole["transmittance"]["mean"], 0.5);
    EXPECT_EQ(whole["irradiance"]["exponent"], 64);
    EXPECT_EQ(whole["error_bar"]["rmse"], 0.1);  // the irradiance stage has none
    EXPECT_EQ(whole["warnings"], Json::parse(R"(["a", "b"])"));
    EXPECT_EQ(whole["timings_s"], Json::parse(R"({"read_hair": 1.0, "irradiance": 4.0, "write": 10.0})"));
    EXPECT_EQ(whole["peak_memory_bytes"], 30);  // the stages ran in processes of their own
    EXPECT_EQ(whole["files"], Json::parse(R"([{"name": "transmittance.npy"}, {"name": "preview_transmittance.png"},
                                              {"name": "preview_irradiance.png"}])"));
}

TEST(BakeManifest, JoinsAnyNumberOfStages) {
    const auto part = [](const std::string& kind) {
        return StageManifest{kind, R"({"stages": {")" + kind +
                                       R"(": {}}, "files": [{"name": "preview.png"}, {"name": ")" + kind +
                                       R"(.npy"}], "timings_s": {"write": 1}})"};
    };
    const Json whole = Json::parse(make_bake_manifest("id", "{}", {part("a"), part("b"), part("c")}));
    EXPECT_EQ(whole["stages"], Json::parse(R"({"a": {}, "b": {}, "c": {}})"));
    EXPECT_EQ(whole["files"].size(), 6u);
    EXPECT_EQ(whole["files"][4]["name"], "preview_c.png");
    EXPECT_EQ(whole["timings_s"]["write"], 3);
}

TEST(BakeManifest, OfOneStageIsThatStages) {
    const Json whole = Json::parse(make_bake_manifest("id", "{}", {{"transmittance", transmittance}}));
    EXPECT_FALSE(whole.contains("irradiance"));
    EXPECT_EQ(whole["stages"], Json::parse(R"({"transmittance": {"key": "k"}})"));
}

}  // namespace
}  // namespace hairbake
