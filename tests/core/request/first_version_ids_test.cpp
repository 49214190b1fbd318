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

/// Keys of transmittance were printed by a program of that commit. Its keys of irradiance differed in nothing but the
/// algorithm version: 2 then, 3 now (CHANGELOG.md). The inputs have the digests "aa" (hair), "bb" (occluder), "cc" (receiver), "dd"
/// (environment), as far as the request names these files.
const Pin pins[] = {
    {R"({"hair": "h", "environment": "e"})", "68b6cba1f5358760b36d47eff3a31a4559abf85e844496909fcd22ad1b4d0c4f",
     "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "bc2baf9599f873c1c6fa634dace1b0d4c3db70dfff1ae7f2e498841872cbd3f1"},
    {R"({"hair": "h"})", "68b6cba1f5358760b36d47eff3a31a4559abf85e844496909fcd22ad1b4d0c4f", "",
     "ec18b765c63c308369921d1500dd1e792ba7a0dcde5bac04bc5a91ec371eb025"},
    {R"({"environment": "e"})", "", "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "e0dcbe569551178590820564b97a254a3fd0b895cbcb6dd182b1bf2ff77047aa"},
    {R"({"hair": "h", "environment": "e", "occluder": "o", "receiver": "r", "transmittance": {"sh_bands": 4, "bent_cone": true}})",
     "226e107d82f40f61096506f53be13747418b3650eb279928e903599acd61dc6e",
     "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "a76f6be015c855ab033fbd5f5e7867de8065bbc21569e6904503071811c0a836"},
    {R"({"hair": "h", "strand": {"width": 0.25, "width_scale": 2.5, "opacity": "from_file"}, "transmittance": {"method": "trace", "directions": 49, "direction_set": "stratified", "seed": 9007199254740991}})",
     "360ffd4a1ad448d5d8309671f66e82edfc3ba0fbef63fed71b8f77b14104c332", "",
     "c89613c519ebd7e0bb171151c2b2f7445181763332b08e36673a4cad8f2afc71"},
    {R"({"hair": "h", "transmittance": {"method": "opacity_maps", "opacity_maps": {"layers": 4, "layer_spacing": 1.5, "resolution": 64}}})",
     "a9b00337c7e746a99a17eb09d455ce7107dfa445b5da2922e4bef0be1290fcf8", "",
     "f1d7849b3ab64fff53460c65b4122275bd137804680a9ff91f5c687460b47444"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 32, "voxels": 128, "reference_vertices": 64}, "irradiance": {"face_size": 8, "specular_maps": 17}})",
     "e66b6e60ae34251c74d9e086de44ac7210d44ef0fef0d6151a5a916c737e5ff6",
     "b50ed61ad1e514e2c0f436399c3e6a44cffb002d844f991c3686fce9a3ffa5a1",
     "ab5863bfcaf1a8137adbc8aabbe84c69d54dd3cb324c8c0cbf3c4e43493274de"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 256, "voxels": 512, "reference_vertices": 1024}, "irradiance": {"face_size": 32, "specular_maps": 65}})",
     "ec303ed5e4260861265e00a22907fb12c04b038e9e8e17a886bdbd8fa05787c2",
     "345017c71a7bf5ba7b0cee7e60b1aef755315bb0c016c79c613ce85419a85878",
     "8ce1556f78eb08d2003eebfcfc832fdce40cab4ecef3b219670b0d753f6b7621"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 100, "direction_set": "random"}, "irradiance": {"face_size": 16, "specular_maps": 9, "exponent": 64, "method": "sh", "sh_bands": {"diffuse": 3, "specular": 8}}})",
     "bacac3144a61f3a5ff0b0327bdadfdfea154a754904013b6abddd4c685f63f44",
     "5c58864fae34b26d74bcadebae1719cc83409da7d9312a4c8447fe07f56611f1",
     "03100f337f863351d9e7586cb332f719f859bc4805429f3cbd737b6f76722eec"},
    {R"({"environment": "e", "irradiance": {"model": "kajiya-kay", "exponent": 12.5, "layout": "latlong", "latlong": "openexr", "rotation_deg": [1, 2.5, -3], "exposure_stops": -1.5, "tint": [0.5, 0.25, 0.125], "invalid_radiance": "clamp"}})",
     "", "f66bf56d66303f65bddbbef9a88296fb5e4a12aa4fcc76330669ded83055a968",
     "bb0b54b157e36dfea4b584ca5b96599a83cbe7c897b8ffd4f3c2f05cffb01e34"},
    {R"({"environment": "e", "irradiance": {"method": "sh", "sh_error": 0.05, "clamp_negative": false, "lights": [{"direction": [0, 1, 0.5], "irradiance": [3, 3, 2.5]}]}, "outputs": ["ktx2", "dds", "raw", "npy"]})",
     "", "5e9024e7d9be5e6de3ac7e676885274d30e34ea2c1559d12694063d0b5539888",
     "1c6b3daa4f9db5aced84cbd0d16b200889e2831d2f630a1e9dc2e7b127191488"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"voxel_size": 0.125}, "outputs": ["vdb", "glb", "raw", "hair", "exr", "npy"]})",
     "d8ab036299680a9dae8c98e5a2b67e31a9c2328f350041ee9f2d7bc2511cf7a5",
     "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "b44b590aaedc3d33d4c675c2d27c92162fc22457944b935cd7ef9710f57afc01"},
    {R"({"hair": "h", "environment": "e", "irradiance": {"rotation_deg": [0, 90, 0]}, "outputs": []})",
     "68b6cba1f5358760b36d47eff3a31a4559abf85e844496909fcd22ad1b4d0c4f",
     "a6c20edc29e7227e71c4e3e73f82f9b66936e8f4a67a6663731f30617777f203",
     "e8eb7a2ee4dbe099d6e9460129e9d6993395f601736686d0439ab7c045d63f0b"},
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
