// Valid HAIR files: reading them, and writing them back as the same bytes.
#include "core/hair/hair_format_writer.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/base/error.h"
#include "core/hair/hair_file.h"
#include "tests/support/hair_bytes.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

std::string as_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string written(const HairModel& model, const HairFileExtras& extras) {
    std::ostringstream stream;
    write_hair(model, stream, extras);
    return stream.str();
}

std::string written(const Groom& groom) { return written(groom.model, groom.extras); }

TEST(HairFile, ReadsEveryCombinationOfTheArrayBitsThatHasPoints) {
    for (std::uint32_t arrays = 0; arrays < 32; ++arrays) {
        if (!(arrays & kPoints)) continue;
        SCOPED_TRACE(arrays);
        const Groom groom = read_groom(make_hair_bytes(arrays, {2, 2}), "combination.hair");
        const HairModel& model = groom.model;
        EXPECT_EQ(model.strand_begin, (std::vector<std::uint32_t>{0, 3, 6}));
        ASSERT_EQ(model.vertex_count(), 6u);
        EXPECT_EQ(model.positions[5], Vec3f(5, 2.5f, -5));
        EXPECT_EQ(groom.extras.has_segments_array, bool(arrays & kSegments));
        EXPECT_EQ(model.thickness.size(), arrays & kThickness ? 6u : 0u);
        EXPECT_EQ(model.transparency.size(), arrays & kTransparency ? 6u : 0u);
        EXPECT_EQ(model.colors.size(), arrays & kColors ? 6u : 0u);
        if (arrays & kThickness) {
            EXPECT_EQ(model.thickness[4], 0.01f + 0.001f * 4);
        }
        if (arrays & kTransparency) {
            EXPECT_EQ(model.transparency[4], 0.25f);
        }
        if (arrays & kColors) {
            EXPECT_EQ(model.colors[4], Vec3f(0.1f, 0.2f, 0.001f * 4));
        }
        EXPECT_EQ(groom.extras.default_segments, 2u);
        // The model has a default only where it has no array.
        EXPECT_EQ(model.default_thickness, arrays & kThickness ? 0 : 0.02f);
        EXPECT_EQ(model.default_transparency, arrays & kTransparency ? 0 : 0.5f);
        EXPECT_EQ(model.default_color, arrays & kColors ? Vec3f(1, 1, 1) : Vec3f(0.9f, 0.8f, 0.7f));
        EXPECT_EQ(groom.description, "hello");
        EXPECT_TRUE(groom.warnings.empty());
    }
}

TEST(HairFile, WritesTheSameBytesThatItRead) {
    for (std::uint32_t arrays = 0; arrays < 32; ++arrays) {
        if (!(arrays & kPoints)) continue;
        for (const std::vector<std::uint16_t>& segments :
             {std::vector<std::uint16_t>{}, {0}, {0, 0, 0}, {4, 4}, {3, 3, 3, 3, 3}}) {
            SCOPED_TRACE(arrays);
            const HairBytes file = make_hair_bytes(arrays, segments);
            EXPECT_EQ(written(read_groom(file, "again.hair")), as_text(file));
        }
    }
}

TEST(HairFile, ReadsStrandsOfDifferentLengthsAndOfOnePoint) {
    const HairModel model = read_hair(make_hair_bytes(kSegments | kPoints, {0, 3, 0, 1}), "mixed.hair");
    EXPECT_EQ(model.strand_begin, (std::vector<std::uint32_t>{0, 1, 5, 6, 8}));
    EXPECT_EQ(model.strand_count(), 4u);
}

TEST(HairFile, ReadsTheLongestStrandThatTheFormatHolds) {
    const Groom groom = read_groom(make_hair_bytes(kSegments | kPoints, {65535}), "long.hair");
    EXPECT_EQ(groom.model.vertex_count(), 65536u);
    EXPECT_EQ(written(groom), as_text(make_hair_bytes(kSegments | kPoints, {65535})));
}

TEST(HairFile, TakesTheDefaultSegmentsWithoutASegmentsArray) {
    const Groom groom = read_groom(make_hair_bytes(kPoints, {4, 4, 4}), "default.hair");
    EXPECT_EQ(groom.model.strand_begin, (std::vector<std::uint32_t>{0, 5, 10, 15}));
    EXPECT_FALSE(groom.extras.has_segments_array);
}

TEST(HairFile, ReadsAFileWithoutStrands) {
    const HairModel model = read_hair(make_hair_bytes(kSegments | kPoints, {}), "empty.hair");
    EXPECT_EQ(model.strand_count(), 0u);
    EXPECT_EQ(model.vertex_count(), 0u);
}

TEST(HairFile, ADefaultThatIsNotUsedMayBeJunk) {
    HairBytes file = make_hair_bytes(kSegments | kPoints | kThickness, {1});
    file.set(20, std::uint32_t{0x7FC00001});  // a NaN as default thickness beside a thickness array
    EXPECT_EQ(written(read_groom(file, "junk.hair")), as_text(file));
}

TEST(HairFile, GivesTheSameModelFromDiskAndFromMemory) {
    const TemporaryFolder folder;
    const HairBytes file = make_hair_bytes(31, {2, 5, 0});
    const Groom groom = read_groom(file, "memory.hair");
    write_hair(groom.model, folder / "disk.hair", groom.extras);
    EXPECT_EQ(written(read_groom(folder / "disk.hair")), as_text(file));
}

TEST(HairFile, GreyVertexColoursChangeNothingElse) {
    const Groom groom = read_groom(make_hair_bytes(31, {2, 0, 1}), "grey.hair");
    const std::vector<float> transmittance{0, 0.1f, 0.25f, 0.5f, 0.75f, 1};
    const std::string before = written(groom);
    const std::string after = written(with_transmittance_as_colors(groom.model, transmittance), groom.extras);
    // The colours are the last array: 6 points of 12 bytes. Everything before them is the same.
    ASSERT_EQ(after.size(), before.size());
    EXPECT_EQ(after.substr(0, after.size() - 72), before.substr(0, before.size() - 72));
    const HairModel read_back = read_hair(std::as_bytes(std::span(after)), "after.hair");
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(read_back.colors[i], Vec3f(transmittance[i]));
}

TEST(HairFile, GreyVertexColoursAreAddedWhereThereWereNone) {
    const Groom groom = read_groom(make_hair_bytes(kPoints | kThickness, {1, 1}), "plain.hair");
    const std::vector<float> transmittance{1, 0.5f, 0.25f, 0};
    std::string before = written(groom);
    const std::string after = written(with_transmittance_as_colors(groom.model, transmittance), groom.extras);
    // Only the colour bit (16) of the array bits at offset 12 changes, and 4 points of 12 bytes follow.
    before[12] = static_cast<char>(before[12] | kColors);
    EXPECT_EQ(after.substr(0, before.size()), before);
    EXPECT_EQ(after.size(), before.size() + 48);
}

TEST(HairFile, ExtrasOfAnotherFormatHoldTheDefaultsAndAsMuchTextAsFits) {
    HairModel model;
    model.strand_begin = {0, 1};
    model.positions = {{1, 2, 3}};
    model.default_thickness = 0.5f;
    const HairFileExtras extras = make_hair_file_extras(model, std::string(100, 'x'));
    const std::string file = written(model, extras);
    const Groom again = read_groom(std::as_bytes(std::span(file)), "made.hair");
    EXPECT_EQ(again.description, std::string(88, 'x'));
    EXPECT_EQ(again.model.default_thickness, 0.5f);
    EXPECT_EQ(again.model.default_color, Vec3f(1, 1, 1));
    EXPECT_EQ(written(again), file);
}

TEST(HairFile, ReportsADiskThatTakesNothing) {
    const HairModel model = read_hair(make_hair_bytes(31, {2}), "full.hair");
    for (const char* file : {"/dev/full", "/no/such/folder/file.hair"}) {
        try {
            write_hair(model, file);
            ADD_FAILURE() << "writing to " << file << " went unnoticed";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::out_of_resources);
            EXPECT_NE(std::string(error.what()).find(file), std::string::npos) << error.what();
        }
    }
}

TEST(HairFile, RefusesToWriteAModelWhoseArraysContradictEachOther) {
    const HairModel good = read_hair(make_hair_bytes(31, {2, 1}), "good.hair");
    HairFileExtras no_segments_array;  // strands of 2 and 1 segments have no common default
    no_segments_array.has_segments_array = false;
    EXPECT_THROW(written(good, no_segments_array), Error);
    std::vector<HairModel> models(5, good);
    models[0].thickness.pop_back();
    models[1].colors.pop_back();
    models[2].strand_begin.back() = 4;
    models[3].strand_begin = {0, 5, 5};  // a strand without a point
    models[4].transparency.pop_back();
    for (const HairModel& model : models) EXPECT_THROW(written(model, {}), Error);
    EXPECT_THROW(with_transmittance_as_colors(good, std::vector<float>(3)), Error);
}

}  // namespace
}  // namespace hairbake
