#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/irradiance/irradiance_maps.h"
#include "core/sample/sky_generator.h"
#include "tests/support/kajiya_kay.h"
#include "tests/support/make_map.h"
#include "tests/support/pixel_sum.h"

namespace hairbake {
namespace {

std::string field_at_fault(const std::function<void(IrradianceSettings&)>& change) {
    IrradianceSettings settings;
    change(settings);
    try {
        validate(settings);
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::usage);
        return e.field();
    }
    return "none";
}

TEST(IrradianceSettings, TheFirstWrongFieldIsNamed) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(field_at_fault([](auto&) {}), "none");
    EXPECT_EQ(field_at_fault([](auto& s) { s.face_size = 3; }), "irradiance.face_size");
    EXPECT_EQ(field_at_fault([](auto& s) { s.face_size = 257; }), "irradiance.face_size");
    EXPECT_EQ(field_at_fault([](auto& s) { s.specular_maps = 1; }), "irradiance.specular_maps");
    EXPECT_EQ(field_at_fault([&](auto& s) { s.sh_error = nan; }), "irradiance.sh_error");
    EXPECT_EQ(field_at_fault([](auto& s) { s.sh_error = 0; }), "irradiance.sh_error");
    EXPECT_EQ(field_at_fault([](auto& s) { s.sh_bands_diffuse = 0; }), "irradiance.sh_bands.diffuse");
    EXPECT_EQ(field_at_fault([](auto& s) { s.sh_bands_specular = 129; }), "irradiance.sh_bands.specular");
}

// RMS over the largest value on a few texels; both methods.
void expect_accurate(double exponent, int face_size, double exact_limit, int map_width = 256) {
    Progress progress;
    const EnvironmentMap map = generate_sky(Sky::sunny, map_width, 1);
    IrradianceSettings settings;
    const FiberSettings fiber = testing::kajiya_kay(exponent);
    settings.face_size = face_size;
    settings.specular_maps = 5;
    const testing::TexelSample sample = testing::sample_texels(face_size, std::max(1, face_size * face_size / 16));
    const std::vector<Vec3d> truth = testing::sum_over_pixels(map, sample.tangents, exponent, 5);
    const IrradianceMaps exact = bake_irradiance(map, settings, fiber, progress);
    const testing::MapError exact_error = testing::compare(exact, sample.texels, truth);
    EXPECT_LT(exact_error.diffuse, exact_limit) << exponent << ' ' << face_size;
    EXPECT_LT(exact_error.specular, exact_limit) << exponent << ' ' << face_size;
    settings.method = IrradianceMethod::sh;
    const IrradianceMaps sh = bake_irradiance(map, settings, fiber, progress);
    const testing::MapError sh_error = testing::compare(sh, sample.texels, truth);
    // A hundred texels instead of the sphere: an RMS of a peaky error varies by some ten per cent.
    EXPECT_LT(sh_error.diffuse, 1.3 * sh.predicted_error_diffuse) << exponent << ' ' << face_size;
    EXPECT_LT(sh_error.specular, 1.3 * sh.predicted_error_specular) << exponent << ' ' << face_size;
}

TEST(IrradianceSettings, ExtremeExponentsWork) {
    expect_accurate(1, 16, 0.003);
    expect_accurate(4096, 16, 0.003);
    // p = 0 is a jump of 1: a light within half a table step (0.1 degree) of it may be on the wrong side, the sun
    // included, which a texel centre meets with a chance of 1e-3. The sun is at most the largest value: sqrt(1e-3).
    expect_accurate(0, 16, 0.032);
}

TEST(IrradianceSettings, ExtremeFaceSizesWork) {
    expect_accurate(64, 4, 0.003);
    expect_accurate(64, 256, 0.003, 64);  // few lights, for speed
}

TEST(IrradianceMapsStage, UnrepairedRadianceIsAnErrorAndNeverANaN) {
    Progress progress;
    EnvironmentMap map = testing::noise_map(64, 1);
    map.pixels[100].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(bake_irradiance(map, {}, {}, progress), Error);
    // Finite, but its sum over the sphere is not in single precision.
    for (Vec3f& p : map.pixels) p = Vec3f(3e38f);
    EXPECT_THROW(bake_irradiance(map, {}, {}, progress), Error);
}

TEST(IrradianceMapsStage, CoarseSettingsAreWarnedOf) {
    Progress progress;
    const EnvironmentMap map = generate_sky(Sky::sunny, 128, 1);
    IrradianceSettings settings;
    EXPECT_TRUE(bake_irradiance(map, settings, {}, progress).warnings.empty());
    settings.specular_maps = 5;  // error up to the whole sun
    settings.face_size = 4;      // 29 degrees a texel against 8.4 of the lobe
    EXPECT_EQ(bake_irradiance(map, settings, {}, progress).warnings.size(), 2u);
}

TEST(IrradianceMapsStage, ACancelledBakeStops) {
    Progress progress;
    progress.cancel();
    try {
        bake_irradiance(testing::noise_map(64, 1), {}, {}, progress);
        FAIL() << "not cancelled";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::cancelled);
    }
}

}  // namespace
}  // namespace hairbake
