#include "core/request/request.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/core/request/expect_error.h"

namespace hairbake {
namespace {

BakeRequest valid() {
    BakeRequest request;
    request.hair = "model.hair";
    request.environment = "sky.hdr";
    return request;
}

void expect_refused(const BakeRequest& request, const std::string& field, const std::vector<std::string>& pieces = {}) {
    expect_error([&] { validate(request); }, ErrorKind::usage, field, pieces);
}

TEST(Request, DefaultsWithAnInputAreValid) {
    EXPECT_NO_THROW(validate(valid()));
    BakeRequest hair_alone = valid(), environment_alone = valid();
    hair_alone.environment.reset();
    environment_alone.hair.reset();
    EXPECT_NO_THROW(validate(hair_alone));
    EXPECT_NO_THROW(validate(environment_alone));
}

TEST(Request, NeitherHairNorEnvironmentIsRefusedWithBothFlagsNamed) {
    expect_refused(BakeRequest{}, "hair", {"--hair", "--env"});
}

TEST(Request, RefusalNamesFieldValueAndRange) {
    BakeRequest request = valid();
    request.transmittance.voxels = 16;
    expect_refused(request, "transmittance.voxels", {"transmittance.voxels is 16", "32 to 1024"});
}

TEST(Request, NanIsInNoRange) {
    BakeRequest request = valid();
    request.strand.opacity = std::numeric_limits<double>::quiet_NaN();
    expect_refused(request, "strand.opacity");
    request = valid();
    request.strand.width = std::numeric_limits<double>::quiet_NaN();
    expect_refused(request, "strand.width");
    request = valid();
    request.environment_settings.rotation_deg[1] = std::numeric_limits<double>::infinity();
    expect_refused(request, "environment_settings.rotation_deg");
}

TEST(Request, StratifiedSetsWantASquareCount) {
    BakeRequest request = valid();
    request.transmittance.direction_set = DirectionSet::stratified;
    EXPECT_NO_THROW(validate(request));  // 100 = 10 * 10
    request.transmittance.directions = 99;
    expect_refused(request, "transmittance.directions", {"99", "square"});
}

TEST(Request, MeshesWantHairBesideThem) {
    BakeRequest request;
    request.environment = "a.hdr";
    request.occluder = "head.obj";
    expect_refused(request, "occluder", {"without hair"});
    request.occluder.reset();
    request.receiver = "head.obj";
    expect_refused(request, "receiver", {"without hair"});
    request.hair = "a.hair";
    EXPECT_NO_THROW(validate(request));
    request.receiver = "";
    expect_refused(request, "receiver", {"empty"});
}

TEST(Request, OpacityMapsTakeNoOccluder) {
    BakeRequest request;
    request.hair = "a.hair";
    request.occluder = "head.obj";
    request.transmittance.method = TransmittanceMethod::opacity_maps;
    expect_refused(request, "occluder", {"opacity_maps", "auto, volume and trace"});
    request.transmittance.method = TransmittanceMethod::trace;
    EXPECT_NO_THROW(validate(request));
}

TEST(Request, ALightHasALengthAndNoNegativeIrradiance) {
    BakeRequest request;
    request.environment = "a.hdr";
    request.irradiance.lights = {{{0, 2, 0}, {1, 1, 1}}};
    EXPECT_NO_THROW(validate(request));
    request.irradiance.lights.push_back({{0, 0, 0}, {1, 1, 1}});
    expect_refused(request, "irradiance.lights[1].direction", {"of no length"});
    request.irradiance.lights[1] = {{0, 1, 0}, {1, -1, 1}};
    expect_refused(request, "irradiance.lights[1].irradiance", {"-1"});
    request.irradiance.lights.assign(65, {{0, 1, 0}, {1, 1, 1}});
    expect_refused(request, "irradiance.lights", {"65", "at most 64"});
}

TEST(Request, OutputsAreKnownAndNamedOnce) {
    BakeRequest request = valid();
    request.outputs = {};
    EXPECT_NO_THROW(validate(request));
    request.outputs = {"npy", "obj"};
    expect_refused(request, "outputs", {"obj", "npy, exr, hair, ktx2, dds, raw, glb, vdb"});
    request.outputs = {"npy", "exr", "npy"};
    expect_refused(request, "outputs", {"npy twice"});
}

TEST(Request, AVdbNeedsTheMethodWithADensityGrid) {
    BakeRequest request = valid();
    request.outputs = {"vdb"};
    EXPECT_NO_THROW(validate(request));
    for (const auto method : {TransmittanceMethod::volume, TransmittanceMethod::trace}) {
        request.transmittance.method = method;
        EXPECT_NO_THROW(validate(request));
    }
    request.transmittance.method = TransmittanceMethod::opacity_maps;
    expect_refused(request, "outputs", {"no density grid", "auto, volume and trace"});
    request.hair.reset();  // then there is no transmittance, and nothing to refuse
    request.environment = "a.hdr";
    EXPECT_NO_THROW(validate(request));
}

TEST(Request, EveryEndOfARangeIsAllowedAndBeyondIsNot) {
    struct Case {
        const char* field;
        void (*set)(BakeRequest&, double);
        double low, high, step;
    };
    const Case cases[] = {
        {"strand.opacity", [](BakeRequest& r, double v) { r.strand.opacity = v; }, 0, 1, 1e-9},
        {"transmittance.directions", [](BakeRequest& r, double v) { r.transmittance.directions = int(v); }, 1, 4096, 1},
        {"transmittance.voxels", [](BakeRequest& r, double v) { r.transmittance.voxels = int(v); }, 32, 1024, 1},
        {"transmittance.reference_vertices",
         [](BakeRequest& r, double v) { r.transmittance.reference_vertices = int(v); }, 0, 100000, 1},
        {"irradiance.face_size", [](BakeRequest& r, double v) { r.irradiance.face_size = int(v); }, 4, 256, 1},
        {"irradiance.specular_maps", [](BakeRequest& r, double v) { r.irradiance.specular_maps = int(v); }, 2, 257, 1},
        {"fiber.kajiya_kay.exponent", [](BakeRequest& r, double v) { r.fiber.kajiya_kay.exponent = v; }, 0, 4096, 1e-6},
        {"irradiance.sh_bands.diffuse", [](BakeRequest& r, double v) { r.irradiance.sh_bands_diffuse = int(v); }, 1,
         128, 1},
        {"irradiance.sh_bands.specular", [](BakeRequest& r, double v) { r.irradiance.sh_bands_specular = int(v); }, 1,
         128, 1},
        {"environment_settings.exposure_stops",
         [](BakeRequest& r, double v) { r.environment_settings.exposure_stops = v; }, -64, 64, 1e-6},
        {"environment_settings.tint", [](BakeRequest& r, double v) { r.environment_settings.tint[2] = v; }, 0, 1e6,
         1e-6},
    };
    for (const Case& c : cases) {
        BakeRequest request = valid();
        for (const double inside : {c.low, c.high}) {
            c.set(request, inside);
            EXPECT_NO_THROW(validate(request)) << c.field << " = " << inside;
        }
        for (const double outside : {c.low - c.step, c.high + c.step}) {
            c.set(request, outside);
            expect_refused(request, c.field);
        }
    }
}

}  // namespace
}  // namespace hairbake
