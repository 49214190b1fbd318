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

/// Printed by a program of that commit with the digests "aa" (hair), "bb" (occluder), "cc" (receiver), "dd"
/// (environment), as far as the request names these files.
const Pin pins[] = {
    {R"({"hair": "h", "environment": "e"})", "68b6cba1f5358760b36d47eff3a31a4559abf85e844496909fcd22ad1b4d0c4f",
     "34bef0bb738f6e4b855e88c1ffea0d795f4ea4a4adfad8cd849111404579572e",
     "dde704190c01264fcb09eaba5fa31fe59cfac04510b977151394f9c64393d827"},
    {R"({"hair": "h"})", "68b6cba1f5358760b36d47eff3a31a4559abf85e844496909fcd22ad1b4d0c4f", "",
     "ec18b765c63c308369921d1500dd1e792ba7a0dcde5bac04bc5a91ec371eb025"},
    {R"({"environment": "e"})", "", "34bef0bb738f6e4b855e88c1ffea0d795f4ea4a4adfad8cd849111404579572e",
     "be71036d0a103f8bbed3015196a82acea97b5def8b021dddc98c764c5c563440"},
    {R"({"hair": "h", "environment": "e", "occluder": "o", "receiver": "r", "transmittance": {"sh_bands": 4, "bent_cone": true}})",
     "226e107d82f40f61096506f53be13747418b3650eb279928e903599acd61dc6e",
     "34bef0bb738f6e4b855e88c1ffea0d795f4ea4a4adfad8cd849111404579572e",
     "6cdec569705bde8fd601cf8f93cf2d69d93091d0973b63c62c63c3bf2b9de736"},
    {R"({"hair": "h", "strand": {"width": 0.25, "width_scale": 2.5, "opacity": "from_file"}, "transmittance": {"method": "trace", "directions": 49, "direction_set": "stratified", "seed": 9007199254740991}})",
     "360ffd4a1ad448d5d8309671f66e82edfc3ba0fbef63fed71b8f77b14104c332", "",
     "c89613c519ebd7e0bb171151c2b2f7445181763332b08e36673a4cad8f2afc71"},
    {R"({"hair": "h", "transmittance": {"method": "opacity_maps", "opacity_maps": {"layers": 4, "layer_spacing": 1.5, "resolution": 64}}})",
     "a9b00337c7e746a99a17eb09d455ce7107dfa445b5da2922e4bef0be1290fcf8", "",
     "f1d7849b3ab64fff53460c65b4122275bd137804680a9ff91f5c687460b47444"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 32, "voxels": 128, "reference_vertices": 64}, "irradiance": {"face_size": 8, "specular_maps": 17}})",
     "e66b6e60ae34251c74d9e086de44ac7210d44ef0fef0d6151a5a916c737e5ff6",
     "5fd50bdbe61bf84c5097966c7be193eae23617acd1cf67b898e6ff4782d4ef41",
     "a8966c142e13b98fa076c87714c10fb3f106b67c768bd13130a9785159f9142c"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 256, "voxels": 512, "reference_vertices": 1024}, "irradiance": {"face_size": 32, "specular_maps": 65}})",
     "ec303ed5e4260861265e00a22907fb12c04b038e9e8e17a886bdbd8fa05787c2",
     "2693da22a257abce1019202526a525fd28bc84a5809dfdf445fc3889a244371b",
     "7bb66736e521be20239cd9a6d854d6e63029d551d7588408317ce37ddd1e01e8"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 100, "direction_set": "random"}, "irradiance": {"face_size": 16, "specular_maps": 9, "exponent": 64, "method": "sh", "sh_bands": {"diffuse": 3, "specular": 8}}})",
     "bacac3144a61f3a5ff0b0327bdadfdfea154a754904013b6abddd4c685f63f44",
     "070e9313f9c7c777dc4cbcf035e3d4dc56cbe533b5c67969504ffa563177a0d0",
     "39e354b4e980165552b9b17947e73aaf542fd0f5297eb500ab473c936009fd74"},
    {R"({"environment": "e", "irradiance": {"model": "kajiya-kay", "exponent": 12.5, "layout": "latlong", "latlong": "openexr", "rotation_deg": [1, 2.5, -3], "exposure_stops": -1.5, "tint": [0.5, 0.25, 0.125], "invalid_radiance": "clamp"}})",
     "", "3876202e48377b3402cada7a7e94edd2029c108188e2826c61595a974d7797a5",
     "d6508014592174a6e08f9f332c8654451984d14524e406c74eaa86acab990f89"},
    {R"({"environment": "e", "irradiance": {"method": "sh", "sh_error": 0.05, "clamp_negative": false, "lights": [{"direction": [0, 1, 0.5], "irradiance": [3, 3, 2.5]}]}, "outputs": ["ktx2", "dds", "raw", "npy"]})",
     "", "6591d2712edd7a6f4adfb9bcb612565374ee7b848cf2c4dbbf2a6abe133c7807",
     "a74a5c2c975c02d5feae5d7569bf11b0fbd74a911143166926a726a8720d005d"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"voxel_size": 0.125}, "outputs": ["vdb", "glb", "raw", "hair", "exr", "npy"]})",
     "d8ab036299680a9dae8c98e5a2b67e31a9c2328f350041ee9f2d7bc2511cf7a5",
     "34bef0bb738f6e4b855e88c1ffea0d795f4ea4a4adfad8cd849111404579572e",
     "98d70fe43c4290c7ebc523056d65d2bdf2ccade4b3feec9252f9386fb567f36b"},
    {R"({"hair": "h", "environment": "e", "irradiance": {"rotation_deg": [0, 90, 0]}, "outputs": []})",
     "68b6cba1f5358760b36d47eff3a31a4559abf85e844496909fcd22ad1b4d0c4f",
     "8607f08934dceda0389579e0aee4b094b062e823104aa2177f24f420958b9687",
     "b97a7683853e06182eb0f1ef0fed2bb79f408d9bb2516b35cd029465f77ba131"},
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

TEST(FirstVersionIds, RequestsThatNameTheFirstPlacesKeepTheirIds) {
    for (const Pin& pin : pins) {
        BakeRequest request;
        merge_json(request, pin.request, "pin");
        EXPECT_EQ(keys_of(request), pinned(pin)) << pin.request;
    }
}

TEST(FirstVersionIds, TheSameRequestsAtTheNewPlacesHaveTheSameIds) {
    for (const Pin& pin : pins) {
        BakeRequest first, request;
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
                                 "exposure_stops": -1.5, "tint": [0.5, 0.25, 0.125], "invalid_radiance": "clamp"},
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
