// What of a request has no effect, and the facts of fields that the help shows.
#include "core/request/unused_fields.h"

#include <gtest/gtest.h>

#include "core/request/field_facts.h"
#include "core/request/request_json.h"

namespace hairbake {
namespace {

BakeRequest of_hair() {
    BakeRequest request;
    request.hair = "a.hair";
    return request;
}

BakeRequest of_environment() {
    BakeRequest request;
    request.environment = "a.hdr";
    return request;
}

TEST(UnusedFields, AreThoseOfAStageThatDoesNotRun) {
    EXPECT_NE(why_unused(of_environment(), "transmittance.directions").find("there is no hair"), std::string::npos);
    // Relatives: a block's field, an old place, fields of the other stage.
    EXPECT_NE(why_unused(of_environment(), "strand.width"), "");
    EXPECT_NE(why_unused(of_hair(), "irradiance.layout").find("there is no environment"), std::string::npos);
    EXPECT_NE(why_unused(of_hair(), "fiber.kajiya_kay.exponent"), "");
    EXPECT_EQ(why_unused(of_hair(), "transmittance.directions"), "");
    EXPECT_EQ(why_unused(of_environment(), "environment_settings.layout"), "");
    EXPECT_EQ(why_unused(of_hair(), "outputs"), "");
    EXPECT_EQ(why_unused(of_hair(), "no.such.field"), "");
}

TEST(UnusedFields, AreThoseOfAMethodThatIsNotAskedFor) {
    BakeRequest request = of_hair();
    EXPECT_NE(why_unused(request, "transmittance.opacity_maps.layers"), "");
    EXPECT_EQ(why_unused(request, "transmittance.voxels"), "");
    request.transmittance.method = TransmittanceMethod::trace;
    EXPECT_NE(why_unused(request, "transmittance.voxels"), "");
    EXPECT_NE(why_unused(request, "transmittance.voxel_size"), "");
    request.outputs = {"vdb"};
    EXPECT_EQ(why_unused(request, "transmittance.voxels"), "");
    request.outputs = {"npy"};
    request.transmittance.method = TransmittanceMethod::opacity_maps;
    EXPECT_NE(why_unused(request, "transmittance.voxels"), "");
    request.transmittance.method = TransmittanceMethod::opacity_maps;
    EXPECT_EQ(why_unused(request, "transmittance.opacity_maps.layers"), "");
    BakeRequest maps = of_environment();
    for (const char* field : {"irradiance.sh_bands.diffuse", "irradiance.sh_error", "irradiance.clamp_negative"}) {
        maps.irradiance.method = IrradianceMethod::exact;
        EXPECT_NE(why_unused(maps, field), "") << field;
        maps.irradiance.method = IrradianceMethod::sh;
        EXPECT_EQ(why_unused(maps, field), "") << field;
    }
}

TEST(RequestWarnings, AreOfOutputsThatNoStageWritesAndOfVoxelsBesideTheirSize) {
    EXPECT_TRUE(request_warnings(of_environment()).empty());  // "hair" is among the default outputs
    BakeRequest request = of_environment();
    request.outputs = {"npy", "glb", "vdb"};
    ASSERT_EQ(request_warnings(request).size(), 2u);
    EXPECT_NE(request_warnings(request)[0].find("glb"), std::string::npos);
    request = of_hair();
    request.outputs = {"exr", "npy"};
    ASSERT_EQ(request_warnings(request).size(), 1u);
    EXPECT_NE(request_warnings(request)[0].find("exr"), std::string::npos);
    request = of_hair();
    request.transmittance.voxel_size = 0.1;
    EXPECT_TRUE(request_warnings(request).empty());
    request.transmittance.voxels = 64;
    ASSERT_EQ(request_warnings(request).size(), 1u);
    EXPECT_NE(request_warnings(request)[0].find("transmittance.voxels is not used"), std::string::npos);
}

TEST(SetField, TakesNumbersAsPeopleWriteThem) {
    BakeRequest request;
    set_field(request, "strand.width", ".05");
    set_field(request, "transmittance.voxels", "+64");
    set_field(request, "transmittance.seed", "7.");
    set_field(request, "environment_settings.tint", ".5,1.,+2");
    EXPECT_EQ(request.strand.width, 0.05);
    EXPECT_EQ(request.transmittance.voxels, 64);
    EXPECT_EQ(request.transmittance.seed, 7u);
    EXPECT_EQ(request.environment_settings.tint, (std::array<double, 3>{0.5, 1, 2}));
}

TEST(FieldFacts, ListEveryFieldWithRangeUnitAndDefault) {
    std::vector<std::string> paths;
    for (const FieldFacts& facts : field_facts()) {
        paths.push_back(facts.path);
        EXPECT_FALSE(facts.allowed.empty() || facts.standard.empty() || facts.description.empty()) << facts.path;
        EXPECT_EQ(range_text(facts), range_text(facts_of_field(facts.path)));
    }
    EXPECT_EQ(paths, field_paths());
    EXPECT_EQ(range_text(facts_of_field("transmittance.directions")), "1 to 4096 (directions); default 100");
    EXPECT_EQ(range_text(facts_of_field("transmittance.voxels")), "32 to 1024 or auto (voxels); default auto");
    EXPECT_EQ(range_text(facts_of_field("strand.width")), "above 0, up to 1e+18 (model units); default none");
    EXPECT_EQ(range_text(facts_of_field("irradiance.method")), "one of exact, sh; default exact");
    EXPECT_EQ(range_text(facts_of_field("irradiance.clamp_negative")), "true or false; default true");
    EXPECT_EQ(range_text(facts_of_field("environment_settings.rotation_deg")),
              "3 numbers, each -36000 to 36000 (degrees); default 0,0,0");
}

}  // namespace
}  // namespace hairbake
