#include "core/fiber/fiber_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/base/random.h"
#include "core/fiber/kajiya_kay.h"
#include "tests/support/kajiya_kay.h"

namespace hairbake {
namespace {

using std::numbers::pi;

Vec3d random_direction(Random& random) {
    const double z = 2 * random.next() - 1, phi = 2 * pi * random.next(), sine = std::sqrt(1 - z * z);
    return {sine * std::cos(phi), sine * std::sin(phi), z};
}

TEST(FiberModels, EveryModelIsMadeByItsDefaultsAndHasLobes) {
    for (const FiberModelEntry& entry : fiber_models) {
        FiberSettings settings;
        settings.model = entry.kind;
        const auto model = make_fiber_model(settings);
        EXPECT_GE(model->lobes().size(), 1u) << entry.name;
        EXPECT_LE(model->lobes().size(), most_lobes) << entry.name;
        EXPECT_TRUE(model->is_zonal() || !model->zonal_kernels()) << entry.name;
        EXPECT_EQ(entry.has_maps, model->zonal_kernels() != nullptr) << entry.name;
        EXPECT_GT(model->sharpness(), 0) << entry.name;
        EXPECT_EQ(name_of(entry.kind), entry.name);
    }
}

TEST(FiberModels, AParameterOutOfRangeIsNamed) {
    for (const double exponent : {-1.0, 4097.0, std::numeric_limits<double>::quiet_NaN()}) try {
            make_fiber_model(testing::kajiya_kay(exponent));
            FAIL() << exponent << " was allowed";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_EQ(error.field(), "fiber.kajiya_kay.exponent");
        }
}

/// Kernels without azimuth or maps.
class WithoutMaps : public FiberModel {
public:
    std::span<const FiberLobe> lobes() const override {
        static constexpr FiberLobe one[] = {{"one", LobeRole::diffuse, false}};
        return one;
    }
    bool is_zonal() const override { return false; }
    bool is_symmetric_root_tip() const override { return false; }
    double sharpness() const override { return 1; }
    void evaluate(const LightDirections&, const FiberView&, KernelBlock&) const override {}
};

TEST(FiberModels, OneWithoutMapsIsRefusedByNameAndTheOthersAreTold) try {
    zonal_kernels_for_maps(WithoutMaps(), {});
    FAIL() << "not refused";
} catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_EQ(error.field(), "fiber.model");
    EXPECT_NE(std::string(error.what()).find("allowed for maps is one of kajiya-kay"), std::string::npos)
        << error.what();
}

TEST(KajiyaKayModel, ItsBlockIsTheKernelsInSinglePrecision) {
    // Directions in single precision: the argument of the lobe errs by some 2e-7, its p-th power by p times that.
    Random random(1);
    const Vec3d t = random_direction(random), eye = random_direction(random);
    std::vector<float> x(light_block), y(light_block), z(light_block);
    for (std::size_t i = 1; i < light_block; ++i) {  // light 0 is (0, 0, 0), as in a last block
        const Vec3d l = random_direction(random);
        x[i] = float(l.x), y[i] = float(l.y), z[i] = float(l.z);
    }
    KernelBlock kernels;
    for (const double exponent : {0.0, 1.0, 2.5, 64.0}) {
        make_fiber_model(testing::kajiya_kay(exponent))->evaluate({x.data(), y.data(), z.data()}, {t, eye}, kernels);
        EXPECT_TRUE(std::isfinite(kernels.values[diffuse_lobe][0][0]));
        EXPECT_TRUE(std::isfinite(kernels.values[specular_lobe][0][0]));
        for (std::size_t i = 1; i < light_block; ++i) {
            const Vec3d l = normalized(Vec3d(x[i], y[i], z[i]));
            EXPECT_NEAR(kernels.values[diffuse_lobe][0][i], kajiya_kay_diffuse(t, l), 1e-6);
            EXPECT_NEAR(kernels.values[specular_lobe][0][i], kajiya_kay_specular(t, l, eye, exponent),
                        1e-6 * (1 + exponent));
        }
    }
}

TEST(KajiyaKayModel, AnglesAndTheirSinesGiveTheSameZonalKernels) {
    const auto model = make_fiber_model(testing::kajiya_kay(5));
    ASSERT_TRUE(model->zonal_kernels());
    const ZonalKernels& kernels = *model->zonal_kernels();
    for (double light = 0; light < pi; light += 0.1)
        for (double view = 0; view < pi; view += 0.3)
            for (const int lobe : {diffuse_lobe, specular_lobe})
                EXPECT_NEAR(kernels.kernel(lobe, light, view),
                            kernels.kernel(lobe, TangentAngle{std::sin(light), std::cos(light)},
                                           TangentAngle{std::sin(view), std::cos(view)}),
                            5e-15);
    // cos^5 at the half-width is one half.
    EXPECT_NEAR(kernels.kernel(specular_lobe, pi / 2 + kernels.half_width(), pi / 2), 0.5, 1e-14);
}

}  // namespace
}  // namespace hairbake
