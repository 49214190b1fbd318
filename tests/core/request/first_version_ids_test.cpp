// Requests and the keys that the first version (commit 8908c4a) gave them: what a store of it holds must be found.
#include <gtest/gtest.h>

#include "core/request/request_fields.h"
#include "core/request/request_json.h"
#include "core/request/request_presets.h"
#include "core/request/stages.h"

namespace hairbake {
namespace {

struct Pin {
    std::string request, transmittance, irradiance, bake;
};

/// Printed by a program of today with the preset v1. They differ from those that a program of that commit printed in
/// nothing but the algorithm versions of the two stages: 2 and 2 then, 3 and 3 now (CHANGELOG.md). Digests of the
/// inputs are "aa" (hair), "bb" (occluder), "cc" (receiver), "dd" (environment), as far as the request names these
/// files.
const Pin pins[] = {
    {R"({"hair": "h", "environment": "e"})", "c1b93e1247eec446d866362dcf39000f729c9b95404049b3f2789db143c25f24",
     "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "48bb684ea5d98b221551862e001e0e5240456101ada058155586ef2b5e1a000f"},
    {R"({"hair": "h"})", "c1b93e1247eec446d866362dcf39000f729c9b95404049b3f2789db143c25f24", "",
     "243c4662e5f65fe8757a3781c459e6f1e7c9cc053bd1c2cf4fe67531a84338b7"},
    {R"({"environment": "e"})", "", "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "e0dcbe569551178590820564b97a254a3fd0b895cbcb6dd182b1bf2ff77047aa"},
    {R"({"hair": "h", "environment": "e", "occluder": "o", "receiver": "r", "transmittance": {"sh_bands": 4, "bent_cone": true}})",
     "6007014aacbe4e0304e843ee4458e8bed5f67f82335d1805cacf49ca1429f9d1",
     "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "e7c19f576b669c38bdcdb4e328fa52a9c55c707544eb06119ff330a9d10f69e4"},
    {R"({"hair": "h", "strand": {"width": 0.25, "width_scale": 2.5, "opacity": "from_file"}, "transmittance": {"method": "trace", "directions": 49, "direction_set": "stratified", "seed": 9007199254740991}})",
     "7347245340f2e30df1c53919930af73490438244e3754d5e83b9670246a6b71e", "",
     "d047936a768d5e14d6d21b02f1aae8989010632b7c80e18f81c73d2ecc70562e"},
    {R"({"hair": "h", "transmittance": {"method": "opacity_maps", "opacity_maps": {"layers": 4, "layer_spacing": 1.5, "resolution": 64}}})",
     "f7309134ee8caff2a405e711e4bd5b52e53f4fd64aefd045798af597a74168ec", "",
     "1dabc4649648096f7e33baf37f08b954dc2abc9d903bee35e937529fdd603e25"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 32, "voxels": 128, "reference_vertices": 64}, "irradiance": {"face_size": 8, "specular_maps": 17}})",
     "e497ee41b9f1d3ac7d11a2012ece33eb22273e3a3a13b04014d8e660bb92507d",
     "b50ed61ad1e514e2c0f436399c3e6a44cffb002d844f991c3686fce9a3ffa5a1",
     "4a273e3c1ef21645c69aebd188210854c20da2316437c0ec9470ad22b970be4c"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 256, "voxels": 512, "reference_vertices": 1024}, "irradiance": {"face_size": 32, "specular_maps": 65}})",
     "d44fe6cbb540e89818bfcbcb09406e634619a91aa5e9d8f15546974279aed09b",
     "345017c71a7bf5ba7b0cee7e60b1aef755315bb0c016c79c613ce85419a85878",
     "dc96a3edcc4fd1b964f7cec6850c2ab98e670e510dd52bb416016cc5293d089b"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 100, "direction_set": "random"}, "irradiance": {"face_size": 16, "specular_maps": 9, "exponent": 64, "method": "sh", "sh_bands": {"diffuse": 3, "specular": 8}}})",
     "a1de9d3e62640c75eb98ae69e3be5ee91a330c00cca7c0f8189e31f007668406",
     "5c58864fae34b26d74bcadebae1719cc83409da7d9312a4c8447fe07f56611f1",
     "c05e4eee00b14b11033a92b71daa113d708204de4dcb588b35074400c183dbf1"},
    {R"({"environment": "e", "irradiance": {"model": "kajiya-kay", "exponent": 12.5, "layout": "latlong", "latlong": "openexr", "rotation_deg": [1, 2.5, -3], "exposure_stops": -1.5, "tint": [0.5, 0.25, 0.125], "invalid_radiance": "clamp"}})",
     "", "f66bf56d66303f65bddbbef9a88296fb5e4a12aa4fcc76330669ded83055a968",
     "bb0b54b157e36dfea4b584ca5b96599a83cbe7c897b8ffd4f3c2f05cffb01e34"},
    {R"({"environment": "e", "irradiance": {"method": "sh", "sh_error": 0.05, "clamp_negative": false, "lights": [{"direction": [0, 1, 0.5], "irradiance": [3, 3, 2.5]}]}, "outputs": ["ktx2", "dds", "raw", "npy"]})",
     "", "5e9024e7d9be5e6de3ac7e676885274d30e34ea2c1559d12694063d0b5539888",
     "1c6b3daa4f9db5aced84cbd0d16b200889e2831d2f630a1e9dc2e7b127191488"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"voxel_size": 0.125}, "outputs": ["vdb", "glb", "raw", "hair", "exr", "npy"]})",
     "4b561ed63291388d9023bd3699fc4850e486182d0d9300d87b29abfde5843a68",
     "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "1864beb9bccfec19c0d886ca3df1d167e79f1c789fd8ec69b923b62d80f3b5b6"},
    {R"({"hair": "h", "environment": "e", "irradiance": {"rotation_deg": [0, 90, 0]}, "outputs": []})",
     "c1b93e1247eec446d866362dcf39000f729c9b95404049b3f2789db143c25f24",
     "a6c20edc29e7227e71c4e3e73f82f9b66936e8f4a67a6663731f30617777f203",
     "dfd65b8533a058ec3750cd9d297d2559046d535103be3f856e26888a6e48f58e"},
};

/// The keys of the stages by name, and the bake's id under "".
StageKeys keys_of(const BakeRequest& request) {
    InputDigests digests;
    if (request.hair) digests["hair"] = "aa";
    if (request.occluder) digests["occluder"] = "bb";
    if (request.receiver) digests["receiver"] = "cc";
    if (request.environment) digests["environment"] = "dd";
    StageKeys keys;
    for (const Stage* stage : stages_of(request)) keys[std::string(stage->name)] = stage_key(*stage, digests, request);
    keys[""] = bake_id(keys, request);
    return keys;
}

StageKeys pinned(const Pin& pin) {
    StageKeys keys{{"", pin.bake}};
    if (!pin.transmittance.empty()) keys["transmittance"] = pin.transmittance;
    if (!pin.irradiance.empty()) keys["irradiance"] = pin.irradiance;
    return keys;
}

/// Several defaults have changed since.
BakeRequest first_defaults() {
    BakeRequest request;
    apply_preset(request, "v1");
    return request;
}

TEST(FirstVersionIds, RequestsThatNameTheFirstPlacesKeepTheirIds) {
    for (const Pin& pin : pins) {
        BakeRequest request = first_defaults();
        merge_json(request, pin.request, "pin");
        EXPECT_EQ(keys_of(request), pinned(pin)) << pin.request;
    }
}

TEST(FirstVersionIds, TheSameRequestsAtTheNewPlacesHaveTheSameIds) {
    for (const Pin& pin : pins) {
        BakeRequest first = first_defaults(), request;
        merge_json(first, pin.request, "pin");
        EXPECT_TRUE(merge_json(request, to_json(first), "new").empty()) << "to_json names a deprecated place";
        EXPECT_EQ(keys_of(request), pinned(pin)) << pin.request;
    }
}

TEST(FirstVersionIds, ThePresetV1GivesTheIdsOfTheFirstDefaults) {
    BakeRequest request;
    request.hair = "h";
    request.environment = "e";
    apply_preset(request, "v1");
    EXPECT_EQ(keys_of(request), pinned(pins[0]));
}

TEST(FirstVersionIds, ThePresetV1GivesLaterFieldsTheMeaningOfTheFirstVersion) {
    BakeRequest request;
    apply_preset(request, "v1");
    for (const RequestField& field : request_fields())
        if (field.first_value) {
            EXPECT_EQ(field.get(request), *field.first_value) << field.path;
        }
}

TEST(FirstVersionIds, ThePresetV1SetsEveryFieldBack) {
    // Every setting is given another value than the preset's; the preset sets them all back.
    BakeRequest request;
    merge_json(request, R"({
        "hair": "h", "environment": "e",
        "strand": {"width": 0.25, "width_scale": 2.5, "opacity": 0.5, "time": 3},
        "transmittance": {"method": "trace", "directions": 49, "direction_set": "stratified", "seed": 2,
                          "voxels": 128, "voxel_size": 0.125, "sh_bands": 2, "bent_cone": true,
                          "opacity_maps": {"layers": 4, "layer_spacing": 1.5, "resolution": 64},
                          "reference_vertices": 7},
        "fiber": {"kajiya_kay": {"exponent": 12.5}},
        "environment_settings": {"layout": "latlong", "latlong": "openexr", "rotation_deg": [1, 2, 3],
                                 "exposure_stops": -1.5, "tint": [0.5, 0.25, 0.125], "invalid_radiance": "clamp",
                                 "to_primaries": "aces"},
        "irradiance": {"face_size": 8, "specular_maps": 5, "method": "sh", "sh_bands": {"diffuse": 3, "specular": 8},
                       "sh_error": 0.5, "clamp_negative": false,
                       "lights": [{"direction": [0, 1, 0], "irradiance": [1, 2, 3]}]},
        "outputs": ["hair"]})",
               "other");
    apply_preset(request, "v1");
    EXPECT_EQ(keys_of(request), pinned(pins[0]));
}

}  // namespace
}  // namespace hairbake
