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
/// nothing but the algorithm versions of the two stages: 2 and 2 then, 4 and 3 now (CHANGELOG.md). Digests of the
/// inputs are "aa" (hair), "bb" (occluder), "cc" (receiver), "dd" (environment), as far as the request names these
/// files.
const Pin pins[] = {
    {R"({"hair": "h", "environment": "e"})", "67a591fd3ecdd8eaeab1147e9441c7036df7b40f12ae032a82d2a3d3e8eec68e",
     "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "90be0923043c115d01174aa4b887ef5035e97d74079fa118d03f3136ada29c12"},
    {R"({"hair": "h"})", "67a591fd3ecdd8eaeab1147e9441c7036df7b40f12ae032a82d2a3d3e8eec68e", "",
     "859a71d71609159eaa6b43ef4c907de71efe59a0163f77777d2491de011fef4c"},
    {R"({"environment": "e"})", "", "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "e0dcbe569551178590820564b97a254a3fd0b895cbcb6dd182b1bf2ff77047aa"},
    {R"({"hair": "h", "environment": "e", "occluder": "o", "receiver": "r", "transmittance": {"sh_bands": 4, "bent_cone": true}})",
     "e4f7c90ee3a8f29fad17dd4ec09f84177ac082788ebe57ca64331728ce6379b9",
     "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "2707bbdea8e3dc294d7c8ccab7eef299fa26c86fcff53c132cfeba3c07ed8bd3"},
    {R"({"hair": "h", "strand": {"width": 0.25, "width_scale": 2.5, "opacity": "from_file"}, "transmittance": {"method": "trace", "directions": 49, "direction_set": "stratified", "seed": 9007199254740991}})",
     "e78b4637d9e4b9d72af2fadd06284d8bd4491e32d2ca97796d1f844e8994b863", "",
     "59e72f3634c77b8cfeab30a9ff8ddd8c6092df4e054f0c8cd302f033b6188f0d"},
    {R"({"hair": "h", "transmittance": {"method": "opacity_maps", "opacity_maps": {"layers": 4, "layer_spacing": 1.5, "resolution": 64}}})",
     "3541be2ab3503caf7d757a40fad7e5246c3682f27bc44d9ee48188770c988ac7", "",
     "d34818070a7d0b7d59a98f12b88dde1e1055788593722c747240a2dfe7f028f2"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 32, "voxels": 128, "reference_vertices": 64}, "irradiance": {"face_size": 8, "specular_maps": 17}})",
     "0e8fbc360b37af69beef4008c9303c7ac6f4f58787d31adf63f7e203f2bbef6c",
     "b50ed61ad1e514e2c0f436399c3e6a44cffb002d844f991c3686fce9a3ffa5a1",
     "85503fbbd5ef777d1bf3b21e4c2f315e725fd9217fb4c44f4a55c5055e1e5c00"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 256, "voxels": 512, "reference_vertices": 1024}, "irradiance": {"face_size": 32, "specular_maps": 65}})",
     "92378b02fe1f08c1e68ad245e761a9cdd02185d8b24bcffb842a0c8876867faf",
     "345017c71a7bf5ba7b0cee7e60b1aef755315bb0c016c79c613ce85419a85878",
     "cee920b87c653d1551c3c91dbd98c70f7f5bf06aa268610fa9a2dd964a51d038"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"directions": 100, "direction_set": "random"}, "irradiance": {"face_size": 16, "specular_maps": 9, "exponent": 64, "method": "sh", "sh_bands": {"diffuse": 3, "specular": 8}}})",
     "73f7478be7f9e361bb153c9e9e52a940b9f48f6942e5e7507a744c57a75af580",
     "5c58864fae34b26d74bcadebae1719cc83409da7d9312a4c8447fe07f56611f1",
     "4371a56b5fec8168f980fb4895bf11762bceee7cd567b24e644aff101517215d"},
    {R"({"environment": "e", "irradiance": {"model": "kajiya-kay", "exponent": 12.5, "layout": "latlong", "latlong": "openexr", "rotation_deg": [1, 2.5, -3], "exposure_stops": -1.5, "tint": [0.5, 0.25, 0.125], "invalid_radiance": "clamp"}})",
     "", "f66bf56d66303f65bddbbef9a88296fb5e4a12aa4fcc76330669ded83055a968",
     "bb0b54b157e36dfea4b584ca5b96599a83cbe7c897b8ffd4f3c2f05cffb01e34"},
    {R"({"environment": "e", "irradiance": {"method": "sh", "sh_error": 0.05, "clamp_negative": false, "lights": [{"direction": [0, 1, 0.5], "irradiance": [3, 3, 2.5]}]}, "outputs": ["ktx2", "dds", "raw", "npy"]})",
     "", "5e9024e7d9be5e6de3ac7e676885274d30e34ea2c1559d12694063d0b5539888",
     "1c6b3daa4f9db5aced84cbd0d16b200889e2831d2f630a1e9dc2e7b127191488"},
    {R"({"hair": "h", "environment": "e", "transmittance": {"voxel_size": 0.125}, "outputs": ["vdb", "glb", "raw", "hair", "exr", "npy"]})",
     "6e532689a9c6c2340f0538f6ae5c8347f5994cb1fbda03debb9a94c6d1367ecc",
     "31f5226c9db69f63b4093cc8ca44e94936fe98e9b68eeea0ec6b2f747e7fe33b",
     "2fd13d79a0be4e54ec5890050fbe29c55f76df08f698094e607bd11f7abb3a99"},
    {R"({"hair": "h", "environment": "e", "irradiance": {"rotation_deg": [0, 90, 0]}, "outputs": []})",
     "67a591fd3ecdd8eaeab1147e9441c7036df7b40f12ae032a82d2a3d3e8eec68e",
     "a6c20edc29e7227e71c4e3e73f82f9b66936e8f4a67a6663731f30617777f203",
     "ceb769ad9726ce6b364053f656d2e2f3c80c116d57cfd7a804bb3bf06b889271"},
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
