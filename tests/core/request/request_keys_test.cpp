#include "core/request/request_keys.h"

#include <gtest/gtest.h>

#include "core/request/request_json.h"

namespace hairbake {
namespace {

struct Keys {
    std::string transmittance, irradiance, bake;
};

Keys keys_of(const BakeRequest& request) {
    const std::string t = transmittance_key({"aa", "", ""}, request), i = irradiance_key("bb", request);
    return {t, i, bake_id(t, i, request)};
}

TEST(RequestKeys, ALightingChangeLeavesTheTransmittanceKeyAlone) {
    BakeRequest request;
    const Keys before = keys_of(request);
    set_field(request, "irradiance.exposure_stops", "1");
    const Keys after = keys_of(request);
    EXPECT_EQ(before.transmittance, after.transmittance);
    EXPECT_NE(before.irradiance, after.irradiance);
    EXPECT_NE(before.bake, after.bake);
}

TEST(RequestKeys, AHairChangeLeavesTheIrradianceKeyAlone) {
    BakeRequest request;
    const Keys before = keys_of(request);
    set_field(request, "strand.opacity", "0.5");
    EXPECT_NE(before.transmittance, keys_of(request).transmittance);
    EXPECT_EQ(before.irradiance, keys_of(request).irradiance);
    EXPECT_NE(transmittance_key({"aa", "", ""}, request), transmittance_key({"cc", "", ""}, request));
    EXPECT_NE(transmittance_key({"aa", "", ""}, request), transmittance_key({"aa", "mm", ""}, request));
    EXPECT_NE(transmittance_key({"aa", "", "mm"}, request), transmittance_key({"aa", "mm", ""}, request));
    EXPECT_NE(irradiance_key("bb", request), irradiance_key("cc", request));
}

TEST(RequestKeys, PathsAndTheOrderOfOutputsAreInNoKey) {
    BakeRequest request;
    const Keys before = keys_of(request);
    request.hair = "/somewhere/else.hair";
    request.environment = "/somewhere/else.hdr";
    request.occluder = request.receiver = "/somewhere/else.obj";
    request.outputs = {"hair", "exr", "npy"};
    const Keys after = keys_of(request);
    EXPECT_EQ(before.transmittance, after.transmittance);
    EXPECT_EQ(before.irradiance, after.irradiance);
    EXPECT_EQ(before.bake, after.bake);
    request.outputs = {"npy"};
    EXPECT_NE(before.bake, keys_of(request).bake);
}

TEST(RequestKeys, EveryFieldIsInExactlyTheKeysOfItsStage) {
    const std::pair<const char*, const char*> changes[] = {
        {"strand.width", "0.5"},
        {"strand.width_scale", "2"},
        {"strand.opacity", "from_file"},
        {"transmittance.method", "trace"},
        {"transmittance.directions", "81"},
        {"transmittance.direction_set", "random"},
        {"transmittance.seed", "2"},
        {"transmittance.voxels", "64"},
        {"transmittance.voxel_size", "0.1"},
        {"transmittance.sh_bands", "2"},
        {"transmittance.bent_cone", "true"},
        {"transmittance.opacity_maps.layers", "4"},
        {"transmittance.opacity_maps.layer_spacing", "1"},
        {"transmittance.opacity_maps.resolution", "64"},
        {"transmittance.reference_vertices", "5"},
        {"irradiance.face_size", "8"},
        {"irradiance.specular_maps", "9"},
        {"irradiance.exponent", "5"},
        {"irradiance.method", "sh"},
        {"irradiance.sh_bands.diffuse", "4"},
        {"irradiance.sh_bands.specular", "4"},
        {"irradiance.sh_error", "0.1"},
        {"irradiance.clamp_negative", "false"},
        {"irradiance.layout", "latlong"},
        {"irradiance.latlong", "openexr"},
        {"irradiance.rotation_deg", "0,1,0"},
        {"irradiance.exposure_stops", "2"},
        {"irradiance.tint", "1,1,2"},
        {"irradiance.lights", R"([{"direction": [0, 1, 0], "irradiance": [1, 1, 1]}])"},
        {"irradiance.invalid_radiance", "clamp"}};
    const Keys before = keys_of(BakeRequest{});
    for (const auto& [path, value] : changes) {
        BakeRequest request;
        set_field(request, path, value);
        const bool lighting = std::string(path).starts_with("irradiance.");
        const Keys after = keys_of(request);
        EXPECT_EQ(before.transmittance == after.transmittance, lighting) << path;
        EXPECT_EQ(before.irradiance == after.irradiance, !lighting) << path;
    }
}

}  // namespace
}  // namespace hairbake
