// Bakes of TressFX files from other projects. Skipped where the files are missing.
#include <gtest/gtest.h>

#include "core/hair/hair_file.h"
#include "core/volume/opacity_transmittance.h"
#include "tests/support/shared_data.h"
#include "tests/support/strand_models.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

StrandGeometry with_width(const std::filesystem::path& file, double width) {
    StrandSettings settings;
    settings.width = width;
    return make_strand_geometry(read_hair(file), settings);
}

TEST(RealTfx, OfSintelBakesToTheBitsOfItsHairForm) {
    const auto tfx = shared_data("hair/sintel.tfx"), hair = shared_data("hair/sintel.hair");
    if (!exists(tfx) || !exists(hair)) GTEST_SKIP() << missing_data(tfx);
    EXPECT_EQ(bake(with_width(tfx, 1e-4), with_voxels(64, 16)), bake(with_width(hair, 1e-4), with_voxels(64, 16)));
}

TEST(RealTfx, WithSegmentsOf1e7BakesByEitherMethod) {
    const auto file = shared_data("hair/ratboy_mohawk.tfx");
    if (!exists(file)) GTEST_SKIP() << missing_data(file);
    const StrandGeometry strands = with_width(file, 5e-4);
    EXPECT_EQ(strands.degenerate_segment_count, 31u);
    TransmittanceSettings settings = with_voxels(64, 16);
    settings.opacity_maps.resolution = 128;
    Progress progress;
    for (const auto& a :
         {bake(strands, settings), bake_transmittance_opacity_maps({strands}, settings, progress).average}) {
        ASSERT_EQ(a.size(), 2228u * 32);
        double mean = 0;
        for (const float t : a) {
            ASSERT_GE(t, 0);  // fails for a NaN as well
            ASSERT_LE(t, 1);
            mean += double(t) / double(a.size());
        }
        EXPECT_GT(mean, 0.05);
        EXPECT_LT(mean, 0.95);
    }
}

}  // namespace
}  // namespace hairbake
