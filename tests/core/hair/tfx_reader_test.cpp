// TressFX files, built byte by byte, and real ones, which are skipped where they are missing.
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <sstream>

#include "core/base/error.h"
#include "core/hair/hair_file.h"
#include "core/hair/hair_format_writer.h"
#include "core/hair/strand_geometry.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tfx_bytes.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

constexpr std::uint32_t largest = std::numeric_limits<std::uint32_t>::max();

/// The message with which `file` is refused as bad input; it must name the file.
std::string refusal(std::span<const std::byte> file, const std::string& name = "hostile.tfx") {
    try {
        read_hair(file, name);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        EXPECT_EQ(std::string(error.what()).find(name + ": "), 0u) << error.what();
        return error.what();
    }
    return "was read";
}

void expect_in(const std::string& message, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(TfxFile, ReadsPositionsAndColoursOfBothVersionsAndNothingElse) {
    for (const int version : {3, 4}) {
        const HairModel model = read_hair(make_tfx_bytes(version, 3, 4), "small.tfx");
        EXPECT_EQ(model.format, version == 4 ? "TressFX 4.0" : "TressFX 3.0");
        EXPECT_EQ(model.strand_begin, (std::vector<std::uint32_t>{0, 4, 8, 12}));
        for (std::size_t i = 0; i < 12; ++i) {
            const auto x = static_cast<float>(i);
            EXPECT_EQ(model.positions[i], Vec3f(x, 0.5f * x, -x));
            EXPECT_EQ(model.colors[i], Vec3f(0.1f, 0.2f, 0.001f * x));
        }
        EXPECT_TRUE(model.thickness.empty() && model.transparency.empty());
        EXPECT_EQ(model.default_thickness, 0);
        EXPECT_EQ(model.default_transparency, 0);
    }
    const Groom groom = read_groom(make_tfx_bytes(3, 1, 4), "small.tfx");
    EXPECT_EQ(groom.description, "from TressFX 3.0, without its 7 follow hairs a guide");
    EXPECT_EQ(groom.extras.info.data(), groom.description);
}

TEST(TfxFile, AsksForAWidth) {
    const HairModel model = read_hair(make_tfx_bytes(4, 2, 4), "thin.tfx");
    try {
        make_strand_geometry(model, {});
        FAIL() << "was accepted without a width";
    } catch (const Error& error) {
        EXPECT_EQ(error.field(), "strand.width");
        expect_in(error.what(), {"strand.width", "--width"});
    }
    StrandSettings settings;
    settings.width = 0.01;
    EXPECT_EQ(make_strand_geometry(model, settings).widths, std::vector<float>(8, 0.01f));
}

TEST(TfxFile, IsWrittenAsHairWithoutASegmentsArrayHoweverLongTheStrands) {
    // A segments array ends at 65,536 points a strand; here are 70,000.
    for (const std::uint32_t points : {4u, 70'000u}) {
        const auto [model, extras, description, warnings] = read_groom(make_tfx_bytes(4, 2, points), "long.tfx");
        std::ostringstream written;
        write_hair(model, written, extras);
        const HairModel again = read_hair(std::as_bytes(std::span(written.view())), "long.hair");
        EXPECT_EQ(again.positions, model.positions);
        EXPECT_EQ(again.strand_begin, model.strand_begin);
        EXPECT_EQ(again.colors, model.colors);
    }
}

TEST(TfxFile, ReadsAFileWithoutStrandsOrColours) {
    for (const int version : {3, 4}) {
        HairBytes file = make_tfx_bytes(version, 0, 16);
        EXPECT_EQ(read_hair(file, "empty.tfx").strand_count(), 0u);
        file = make_tfx_bytes(version, 2, 4);
        file.set(version == 4 ? kTfx4.colors : kTfx3.colors, std::uint32_t{0});
        EXPECT_TRUE(read_hair(file, "plain.tfx").colors.empty());
    }
}

TEST(TfxFile, LooksAtNoArrayThatItDoesNotRead) {
    for (const int version : {3, 4}) {
        const TfxOffsets& at = version == 4 ? kTfx4 : kTfx3;
        HairBytes file = make_tfx_bytes(version, 2, 4);
        for (const std::size_t field : {at.strand_uv, at.vertex_uv, at.thickness}) file.set(field, largest);
        EXPECT_EQ(read_hair(file, "odd.tfx").vertex_count(), 8u);
    }
}

TEST(TfxFile, RefusesOtherVersions) {
    for (const float version : {0.f, 2.f, 3.1f, 4.1f, 5.f, -4.f, std::numeric_limits<float>::quiet_NaN()}) {
        HairBytes file = make_tfx_bytes(4, 2, 4);
        file.set(0, version);
        expect_in(refusal(file), {"version", "3.0 and 4.0"});
        expect_in(refusal(file, "hostile.hair"), {"\"HAIR\"", "TressFX"});
    }
}

TEST(TfxFile, RefusesAFileTruncatedAnywhereInWhatIsRead) {
    for (const int version : {3, 4}) {
        const HairBytes file = make_tfx_bytes(version, 3, 4);
        for (std::size_t length = 0; length < file.bytes.size(); ++length)
            EXPECT_NE(refusal(std::span(file.bytes).first(length)), "was read") << length;
    }
}

TEST(TfxFile, RefusesHostileCountsBeforeTakingMemory) {
    for (const int version : {3, 4})
        for (int which = 1; which < 4; ++which) {
            HairBytes file = make_tfx_bytes(version, 2, 4);
            if (which & 1) file.set(4, largest);
            if (which & 2) file.set(8, largest);
            expect_in(refusal(file), {"truncated", "4294967295"});
        }
    HairBytes none = make_tfx_bytes(4, 2, 4);
    none.set(8, std::uint32_t{0});
    expect_in(refusal(none), {"2 strands of 0 points"});
}

TEST(TfxFile, RefusesArraysOutsideTheFile) {
    for (const int version : {3, 4}) {
        const TfxOffsets& at = version == 4 ? kTfx4 : kTfx3;
        const HairBytes good = make_tfx_bytes(version, 2, 4);
        const auto size = static_cast<std::uint32_t>(good.bytes.size());
        for (const std::uint32_t offset : {1u, static_cast<std::uint32_t>(at.header) - 1, size - 8 * 12 + 1, size,
                                           size + 1, largest, largest - 15}) {
            HairBytes file = good;
            file.set(at.positions, offset);
            expect_in(refusal(file), {"offset of the positions", std::to_string(offset), std::to_string(at.header)});
            file = good;
            file.set(at.colors, offset);
            expect_in(refusal(file), {"offset of the vertex colours", std::to_string(offset)});
        }
        HairBytes file = good;
        file.set(at.positions, std::uint32_t{0});  // elsewhere 0 means "not there"; a model without points is none
        expect_in(refusal(file), {"offset of the positions", "found 0"});
    }
}

TEST(TfxFile, RefusesNumbersThatAreNotFiniteNamingStrandAndVertex) {
    for (const int version : {3, 4}) {
        const TfxOffsets& at = version == 4 ? kTfx4 : kTfx3;
        HairBytes file = make_tfx_bytes(version, 2, 4);
        std::uint32_t positions = 0, colors = 0;
        std::memcpy(&positions, file.bytes.data() + at.positions, 4);
        std::memcpy(&colors, file.bytes.data() + at.colors, 4);
        const std::size_t stride = version == 4 ? 16 : 12;
        HairBytes infinite = file;
        infinite.set(positions + 6 * stride + 4, std::numeric_limits<float>::infinity());
        expect_in(refusal(infinite), {"strand 1, vertex 2", "y is inf"});
        HairBytes colourless = file;
        colourless.set(colors + 16 * 5, std::numeric_limits<float>::quiet_NaN());
        expect_in(refusal(colourless), {"strand 1, vertex 1", "colour"});
    }
}

TEST(TfxRealFiles, SintelHoldsThePointsOfItsHairForm) {
    const auto tfx = shared_data("hair/sintel.tfx"), hair = shared_data("hair/sintel.hair");
    if (!exists(tfx) || !exists(hair)) GTEST_SKIP() << missing_data(tfx);
    const Groom a = read_groom(tfx), b = read_groom(hair);
    EXPECT_EQ(a.model.strand_begin, b.model.strand_begin);  // 11,400 strands of 16 points
    EXPECT_EQ(a.model.positions, b.model.positions);        // to the last bit: the .hair was derived from this file
    EXPECT_EQ(a.extras.default_segments, b.extras.default_segments);
    EXPECT_EQ(a.extras.has_segments_array, b.extras.has_segments_array);
}

TEST(TfxRealFiles, RatboyHasThirtyOneDegenerateSegments) {
    const auto file = shared_data("hair/ratboy_mohawk.tfx");
    if (!exists(file)) GTEST_SKIP() << missing_data(file);
    const HairModel model = read_hair(file);
    EXPECT_EQ(model.strand_count(), 2228u);
    EXPECT_EQ(model.vertex_count(), 2228u * 32);
    StrandSettings settings;
    settings.width = 0.001;
    const StrandGeometry strands = make_strand_geometry(model, settings);
    EXPECT_EQ(strands.segment_count, 2228u * 31);
    // Counted in numpy: shorter than 1e-6 of the longest side of the bounds, 0.8956 units; the shortest is 1.3e-7.
    EXPECT_EQ(strands.degenerate_segment_count, 31u);
}

}  // namespace
}  // namespace hairbake
