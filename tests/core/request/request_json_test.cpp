#include "core/request/request_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/request/request_presets.h"
#include "tests/core/request/expect_error.h"

namespace hairbake {
namespace {

BakeRequest parsed(const std::string& text) {
    BakeRequest request;
    merge_json(request, text, "test.json");
    return request;
}

void expect_refused(const std::string& text, const std::string& field, const std::vector<std::string>& pieces = {}) {
    expect_error([&] { parsed(text); }, ErrorKind::usage, field, pieces);
}

TEST(RequestJson, EveryFieldMakesTheRoundTrip) {
    // No value is a default, so a field that is lost on the way shows.
    const std::string text = R"({
        "hair": "a.hair", "environment": "b.hdr", "occluder": "c.obj", "receiver": "d.obj",
        "strand": {"width": 0.25, "width_scale": 2.5, "opacity": "from_file", "time": 1.5},
        "transmittance": {"method": "trace", "directions": 49, "direction_set": "stratified", "seed": 9007199254740991,
                          "voxels": 128, "voxel_size": 0.125, "sh_bands": 2, "bent_cone": true,
                          "opacity_maps": {"layers": 4, "layer_spacing": 1.5, "resolution": 64},
                          "reference_vertices": 7},
        "fiber": {"model": "kajiya-kay", "kajiya_kay": {"exponent": 12.5}},
        "environment_settings": {"layout": "latlong", "latlong": "openexr", "rotation_deg": [1.0, 2.0, 3.0],
                                 "exposure_stops": -1.5, "tint": [0.5, 0.25, 0.125], "invalid_radiance": "clamp",
                                 "to_primaries": "acescg"},
        "irradiance": {"face_size": 8, "specular_maps": 5, "method": "sh",
                       "sh_bands": {"diffuse": 3, "specular": 8}, "sh_error": 0.5, "clamp_negative": false,
                       "lights": [{"direction": [0.0, 1.0, 0.0], "irradiance": [1.0, 2.0, 3.0]}]},
        "effective_transmittance": {"enabled": true, "lights": 16, "cosines": 4, "diffuse": "luminance",
                                    "reference_neighborhoods": 9},
        "outputs": ["hair"]})";
    const BakeRequest request = parsed(text);
    EXPECT_EQ(nlohmann::json::parse(to_json(request)), nlohmann::json::parse(text));
    EXPECT_EQ(to_json(parsed(to_json(request))), to_json(request));
    EXPECT_EQ(request.transmittance.seed, 9007199254740991u);
    EXPECT_TRUE(request.strand.opacity_from_file);
    EXPECT_EQ(request.irradiance.sh_bands_specular, 8);
    EXPECT_EQ(request.environment_settings.latlong, LatLong::openexr);
}

TEST(RequestJson, FieldsThatAreNotNamedKeepTheirValues) {
    BakeRequest request = parsed(R"({"hair": "a.hair", "transmittance": {"voxels": 64}})");
    merge_json(request, R"({"transmittance": {"directions": 9}, "irradiance": {"sh_bands": {"diffuse": 5}}})",
               "second");
    EXPECT_EQ(request.hair, "a.hair");
    EXPECT_EQ(request.transmittance.voxels, 64);
    EXPECT_EQ(request.transmittance.directions, 9);
    EXPECT_EQ(request.irradiance.sh_bands_diffuse, 5);
    EXPECT_FALSE(request.irradiance.sh_bands_specular.has_value());
    merge_json(request, R"({"hair": null, "irradiance": {"sh_bands": {"diffuse": "auto"}}})", "third");
    EXPECT_FALSE(request.hair.has_value());
    EXPECT_FALSE(request.irradiance.sh_bands_diffuse.has_value());
}

TEST(RequestJson, FirstPlacesAreTakenWithAWarningEach) {
    BakeRequest request;
    const auto warnings =
        merge_json(request, R"({"irradiance": {"exponent": 5, "tint": [1, 2, 3], "face_size": 8}})", "old.json");
    EXPECT_EQ(request.fiber.kajiya_kay.exponent, 5);
    EXPECT_EQ(request.environment_settings.tint[2], 3);
    EXPECT_EQ(warnings, (std::vector<std::string>{
                            "old.json: irradiance.exponent is deprecated: the field is now fiber.kajiya_kay.exponent",
                            "old.json: irradiance.tint is deprecated: the field is now environment_settings.tint"}));
    EXPECT_EQ(set_field(request, "irradiance.latlong", "openexr").size(), 1u);
    EXPECT_EQ(request.environment_settings.latlong, LatLong::openexr);
    expect_refused(R"({"irradiance": {"tint": "red"}})", "irradiance.tint",
                   {"irradiance.tint is \"red\"", "three numbers"});
}

TEST(RequestJson, AFieldAtBothOfItsPlacesIsRefused) {
    const std::string twice = "fiber.kajiya_kay.exponent is given twice, also as irradiance.exponent";
    expect_refused(R"({"fiber": {"kajiya_kay": {"exponent": 5}}, "irradiance": {"exponent": 5}})",
                   "irradiance.exponent", {twice});
    expect_refused(R"({"irradiance": {"exponent": 5}, "fiber": {"kajiya_kay": {"exponent": 5}}})",
                   "fiber.kajiya_kay.exponent", {twice});
}

TEST(RequestJson, OpacityIsANumberOrFromFile) {
    EXPECT_EQ(parsed(R"({"strand": {"opacity": 0.5}})").strand.opacity, 0.5);
    EXPECT_FALSE(parsed(R"({"strand": {"opacity": 0.5}})").strand.opacity_from_file);
    expect_refused(R"({"strand": {"opacity": "file"}})", "strand.opacity", {"\"file\"", "from_file"});
}

TEST(RequestJson, UnknownFieldsAreNamedWithTheAllowedOnes) {
    expect_refused(R"({"hairs": "a"})", "hairs", {"test.json", "hairs", "hair, environment", "outputs"});
    expect_refused(R"({"transmittance": {"voxel": 3}})", "transmittance.voxel", {"in transmittance", "voxels"});
    expect_refused(R"({"irradiance": {"sh_bands": {"all": 3}}})", "irradiance.sh_bands.all", {"diffuse, specular"});
    expect_refused(R"({"strand.width": 3})", "strand.width", {});
}

TEST(RequestJson, WrongTypesAreNamedWithWhatIsAllowed) {
    expect_refused(R"([1])", "the request", {"an object"});
    expect_refused(R"({"hair": 3})", "hair", {"3", "a string or null"});
    expect_refused(R"({"strand": 3})", "strand", {"an object"});
    expect_refused(R"({"strand": {"width": "wide"}})", "strand.width", {"\"wide\"", "a number or null"});
    expect_refused(R"({"transmittance": {"directions": 9.5}})", "transmittance.directions", {"9.5", "an integer"});
    expect_refused(R"({"transmittance": {"directions": true}})", "transmittance.directions", {"an integer"});
    expect_refused(R"({"transmittance": {"directions": 99999999999}})", "transmittance.directions", {});
    expect_refused(R"({"transmittance": {"seed": -1}})", "transmittance.seed", {});
    expect_refused(R"({"transmittance": {"method": "magic"}})", "transmittance.method",
                   {"auto, volume, opacity_maps, trace"});
    expect_refused(R"({"irradiance": {"clamp_negative": 1}})", "irradiance.clamp_negative", {"true or false"});
    expect_refused(R"({"irradiance": {"rotation_deg": [1, 2]}})", "irradiance.rotation_deg", {"three numbers"});
    expect_refused(R"({"irradiance": {"sh_bands": 3}})", "irradiance.sh_bands", {"an object"});
    expect_refused(R"({"outputs": "npy"})", "outputs", {"a list of strings"});
    EXPECT_EQ(parsed(R"({"transmittance": {"directions": 9.0}})").transmittance.directions, 9);
}

TEST(RequestJson, ALightHasADirectionAndAnIrradianceAndNothingElse) {
    const auto with_light = [](const std::string& light) { return R"({"irradiance": {"lights": [)" + light + "]}}"; };
    const BakeRequest request = parsed(with_light(R"({"irradiance": [4, 5, 6], "direction": [1, 2, 3]})"));
    ASSERT_EQ(request.irradiance.lights.size(), 1u);
    EXPECT_EQ(request.irradiance.lights[0].direction, (Vec3d{1, 2, 3}));
    EXPECT_EQ(request.irradiance.lights[0].irradiance, (Vec3d{4, 5, 6}));
    expect_refused(with_light("{}"), "irradiance.lights[0]", {"direction and irradiance"});
    expect_refused(with_light(R"({"direction": [0, 1, 0], "irradiance": [1, 1, 1], "colour": 1})"),
                   "irradiance.lights[0]", {"direction and irradiance"});
    expect_refused(with_light(R"({"direction": [0, 1], "irradiance": [1, 1, 1]})"), "irradiance.lights[0].direction",
                   {"three numbers"});
    expect_refused(R"({"irradiance": {"lights": {}}})", "irradiance.lights", {"a list of lights"});
}

TEST(RequestJson, BrokenJsonIsAUsageErrorThatNamesTheSource) {
    expect_refused("{\"hair\": ", "", {"test.json is not JSON"});
    expect_refused("", "", {"test.json is not JSON"});
    expect_refused(R"({"strand": {"width": 1e999}})", "", {"test.json is not JSON"});
}

/// What fits into a request file of 1 MiB.
const std::string deep = std::string(500'000, '[') + std::string(500'000, ']');

TEST(RequestJson, DeepNestingIsRefusedBeforeItIsRead) {
    expect_refused(deep, "", {"test.json is nested deeper than 64 levels"});
    expect_refused("{\"outputs\": " + deep + "}", "", {"test.json is nested deeper than 64 levels"});
    // 64 levels are read, and refused for what they are.
    expect_refused("{\"outputs\": " + std::string(63, '[') + std::string(63, ']') + "}", "outputs", {"[[["});
}

TEST(RequestJson, AFailedMergeChangesNothing) {
    BakeRequest request;
    EXPECT_THROW(merge_json(request, R"({"hair": "a", "transmittance": {"voxels": 64, "typo": 1}})", "x"), Error);
    EXPECT_EQ(to_json(request), to_json(BakeRequest{}));
}

TEST(SetField, ReachesEveryFieldByItsPathWithItsOwnJson) {
    const BakeRequest source = parsed(R"({"hair": "a", "strand": {"width": 2.5}, "irradiance": {"method": "sh"}})");
    const auto object = nlohmann::json::parse(to_json(source));
    BakeRequest request;
    for (const std::string& path : field_paths()) {
        std::string pointer = "/" + path;
        for (char& c : pointer)
            if (c == '.') c = '/';
        const auto value = object.at(nlohmann::json::json_pointer(pointer));
        set_field(request, path, value.is_string() ? value.get<std::string>() : value.dump());
    }
    EXPECT_EQ(to_json(request), to_json(source));
}

TEST(SetField, DeepNestingIsRefusedAndUnclosedBracketsAreText) {
    BakeRequest request;
    for (const char* path : {"strand.width", "outputs", "irradiance.lights", "hair"})
        expect_error([&] { set_field(request, path, deep); }, ErrorKind::usage, path, {"nested deeper than 64 levels"});
    expect_error([&] { set_field(request, "outputs", "npy," + deep); }, ErrorKind::usage, "outputs", {"64 levels"});
    set_field(request, "hair", std::string(500, '['));
    EXPECT_EQ(request.hair, std::string(500, '['));
}

TEST(SetField, TakesPlainTextAndListsWithCommas) {
    BakeRequest request;
    set_field(request, "transmittance.method", "trace");
    EXPECT_TRUE(set_field(request, "environment_settings.rotation_deg", "0,90,0").empty());
    set_field(request, "outputs", "npy,exr");
    EXPECT_EQ(request.transmittance.method, TransmittanceMethod::trace);
    EXPECT_EQ(request.environment_settings.rotation_deg[1], 90);
    EXPECT_EQ(request.outputs, (std::vector<std::string>{"npy", "exr"}));
    set_field(request, "outputs", "hair");
    EXPECT_EQ(request.outputs, (std::vector<std::string>{"hair"}));
    set_field(request, "outputs", "[]");
    EXPECT_TRUE(request.outputs.empty());
    set_field(request, "hair", "12");  // a file may be called so
    EXPECT_EQ(request.hair, "12");
}

TEST(SetField, RefusesUnknownPathsAndBlocks) {
    BakeRequest request;
    expect_error([&] { set_field(request, "transmittance.voxel", "3"); }, ErrorKind::usage, "transmittance.voxel",
                 {"voxels"});
    expect_error([&] { set_field(request, "transmittance", "3"); }, ErrorKind::usage, "transmittance", {"block"});
    expect_error([&] { set_field(request, "", "3"); }, ErrorKind::usage, "", {"hair, environment"});
    expect_error([&] { set_field(request, "irradiance.tint", "1,2"); }, ErrorKind::usage, "irradiance.tint", {"three"});
}

TEST(Presets, AreValidRequestsOnceInputsAreGiven) {
    for (const Preset& preset : presets()) {
        BakeRequest request;
        apply_preset(request, preset.name);
        request.hair = "a.hair";
        EXPECT_NO_THROW(validate(request)) << preset.name;
        EXPECT_FALSE(preset_description(preset).empty());
    }
    expect_error(
        [] {
            BakeRequest r;
            apply_preset(r, "best");
        },
        ErrorKind::usage, "preset", {"draft, final, paper, v1"});
}

TEST(Presets, PaperIsThePublishedSetting) {
    BakeRequest request;
    apply_preset(request, "paper");
    EXPECT_EQ(request.transmittance.directions, 100);
    EXPECT_EQ(request.transmittance.direction_set, DirectionSet::random);
    EXPECT_EQ(request.irradiance.specular_maps, 9);
    EXPECT_EQ(request.fiber.kajiya_kay.exponent, 64);
    EXPECT_EQ(request.irradiance.face_size, 16);
    EXPECT_EQ(request.irradiance.method, IrradianceMethod::sh);
    EXPECT_EQ(request.irradiance.sh_bands_diffuse, 3);   // 9 coefficients
    EXPECT_EQ(request.irradiance.sh_bands_specular, 8);  // 64 coefficients
}

}  // namespace
}  // namespace hairbake
