// Files from other programs. Skipped where they are missing.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/hair/hair_file.h"
#include "core/hair/hair_format_writer.h"
#include "core/hair/strand_geometry.h"
#include "tests/support/shared_data.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

std::string bytes_of_file(const std::filesystem::path& file) {
    std::ostringstream bytes;
    bytes << std::ifstream(file, std::ios::binary).rdbuf();
    return bytes.str();
}

std::string bytes_of_model(const HairModel& model, const HairFileExtras& extras) {
    std::ostringstream bytes;
    write_hair(model, bytes, extras);
    return bytes.str();
}

TEST(HairRealFiles, ReadsTheSintelGroom) {
    const auto file = shared_data("hair/sintel.hair");
    if (!exists(file)) GTEST_SKIP() << missing_data(file);
    const auto [model, extras, description, warnings] = read_groom(file);
    EXPECT_EQ(model.strand_count(), 11'400u);  // as its credits say: 11,400 strands of 16 points
    EXPECT_EQ(model.vertex_count(), 11'400u * 16);
    EXPECT_FALSE(extras.has_segments_array);
    EXPECT_EQ(bytes_of_model(model, extras), bytes_of_file(file));
    const StrandGeometry strands = make_strand_geometry(model, {});
    EXPECT_EQ(strands.segment_count, 11'400u * 15);
}

TEST(HairRealFiles, ReadsTheFurWithItsThicknessArray) {
    const auto file = shared_data("hair/fur.hair");
    if (!exists(file)) GTEST_SKIP() << missing_data(file);
    const auto [model, extras, description, warnings] = read_groom(file);
    EXPECT_EQ(model.strand_count(), 50'000u);
    EXPECT_EQ(model.vertex_count(), 200'000u);
    EXPECT_EQ(extras.default_thickness, 0);
    EXPECT_EQ(bytes_of_model(model, extras), bytes_of_file(file));
    const StrandGeometry strands = make_strand_geometry(model, {});
    const auto [thinnest, thickest] = std::minmax_element(strands.widths.begin(), strands.widths.end());
    EXPECT_FLOAT_EQ(*thinnest, 0.0005f);  // as its credits say
    EXPECT_FLOAT_EQ(*thickest, 0.01f);
}

TEST(HairRealFiles, CarriesTransmittanceAsGreyColours) {
    const auto file = shared_data("hair/sintel.hair");
    if (!exists(file)) GTEST_SKIP() << missing_data(file);
    const auto [model, extras, description, warnings] = read_groom(file);
    const std::vector<float> transmittance(model.vertex_count(), 0.5f);
    const std::string before = bytes_of_file(file),
                      after = bytes_of_model(with_transmittance_as_colors(model, transmittance), extras);
    EXPECT_EQ(after.size(), before.size() + 12 * model.vertex_count());
    EXPECT_EQ(after.compare(16, before.size() - 16, before, 16), 0);  // all behind the array bits, up to the colours
}

}  // namespace
}  // namespace hairbake
