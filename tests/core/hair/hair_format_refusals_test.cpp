// HAIR files that are wrong or hostile: each is refused with a message that says where and why.
#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "core/base/error.h"
#include "core/hair/hair_file.h"
#include "tests/support/hair_bytes.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

constexpr std::uint32_t largest = std::numeric_limits<std::uint32_t>::max();

/// The message with which `file` is refused as bad input; it must name the file.
std::string refusal(std::span<const std::byte> file) {
    try {
        read_hair(file, "hostile.hair");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        EXPECT_EQ(std::string(error.what()).find("hostile.hair: "), 0u) << error.what();
        return error.what();
    }
    return "was read";
}

void expect_in(const std::string& message, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(HairFile, RefusesAFileWithoutThePointsArray) {
    for (std::uint32_t arrays = 0; arrays < 32; ++arrays)
        if (!(arrays & kPoints)) expect_in(refusal(make_hair_bytes(arrays, {2, 2})), {"points array", "bit 1"});
}

TEST(HairFile, RefusesAnotherMagic) {
    HairBytes file = make_hair_bytes(31, {2});
    file.set(3, 'S');
    expect_in(refusal(file), {"\"HAIR\""});
}

TEST(HairFile, RefusesArrayBitsWithoutAMeaning) {
    for (int bit = 5; bit < 32; ++bit) {
        HairBytes file = make_hair_bytes(31, {2});
        file.set(12, std::uint32_t{31} | std::uint32_t{1} << bit);
        expect_in(refusal(file), {"array bits", "up to 31"});
    }
}

TEST(HairFile, RefusesAFileTruncatedAtAnyLength) {
    const HairBytes file = make_hair_bytes(31, {2, 0, 3});
    for (std::size_t length = 0; length < file.bytes.size(); ++length) {
        SCOPED_TRACE(length);
        expect_in(refusal(std::span(file.bytes).first(length)), {length < 128 ? "128" : "truncated"});
    }
}

TEST(HairFile, RefusesAnOverLongFile) {
    for (const std::size_t extra : {1u, 2u, 12u, 4096u}) {
        HairBytes file = make_hair_bytes(31, {2, 0, 3});
        file.bytes.resize(file.bytes.size() + extra);
        expect_in(refusal(file), {"over-long", std::to_string(file.bytes.size())});
    }
}

TEST(HairFile, RefusesCountsOfFourThousandMillionBeforeTakingMemory) {
    // Offsets 4, 8 and 16: strands, points and default segments. With the memory taken first, the points alone would
    // ask for 48 GiB.
    for (const std::uint32_t arrays : {std::uint32_t{kPoints}, std::uint32_t{kSegments | kPoints}, std::uint32_t{31}})
        for (int which = 1; which < 8; ++which) {
            HairBytes file = make_hair_bytes(arrays, {2, 2});
            if (which & 1) file.set(4, largest);
            if (which & 2) file.set(8, largest);
            if (which & 4) file.set(16, largest);
            if (arrays & kSegments && which == 4) continue;  // a default that is not used
            SCOPED_TRACE(::testing::Message() << "arrays " << arrays << " which " << which);
            EXPECT_NE(refusal(file), "was read");
        }
}

TEST(HairFile, RefusesManyStrandsOverNoPoints) {
    // 2^32 - 1 strands of (2^32 - 1) + 1 points make 2^64 - 2^32: the product must not wrap around to the 0 points
    // here.
    HairBytes file = make_hair_bytes(kPoints, {});
    file.set(4, largest).set(16, largest);
    expect_in(refusal(file), {"4294967295 strands", "18446744069414584320 points"});
}

TEST(HairFile, RefusesAFileWhosePointCountDisagreesWithItsSegments) {
    HairBytes more = make_hair_bytes(kSegments | kPoints, {2, 3});
    more.set(130, std::uint16_t{4});  // strand 1: 5 points, so 8 in all; the header declares 7
    expect_in(refusal(more), {"strand 1", "8 points", "declares 7"});
    HairBytes fewer = make_hair_bytes(kSegments | kPoints, {2, 3});
    fewer.set(128, std::uint16_t{0});
    expect_in(refusal(fewer), {"5 points", "declares 7"});
    HairBytes by_default = make_hair_bytes(kPoints, {3, 3});
    by_default.set(16, std::uint32_t{2});
    expect_in(refusal(by_default), {"2 strands and 8 points", "2 segments", "6 points"});
}

TEST(HairFile, RefusesCoordinatesThatAreNotFiniteOrAbsurdNamingStrandAndVertex) {
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    for (const float value : {nan, -nan, infinity, -infinity, 1.1e18f, -1.1e18f, std::numeric_limits<float>::max()})
        for (int axis = 0; axis < 3; ++axis) {
            HairBytes file = make_hair_bytes(kSegments | kPoints, {2, 0, 3});
            // Point 6 is vertex 2 of strand 2 (strands start at 0, 3 and 4); the points start at 128 + 3 * 2.
            file.set(134 + 12 * 6 + 4 * axis, value);
            expect_in(refusal(file), {"strand 2, vertex 2", axis == 0 ? "x is" : axis == 1 ? "y is" : "z is", "1e18"});
        }
}

TEST(HairFile, TakesCoordinatesUpToTheLimit) {
    HairBytes file = make_hair_bytes(kPoints, {1});
    file.set(128, 1e18f).set(132, -1e18f);
    EXPECT_EQ(read_hair(file, "limit.hair").positions[0], Vec3f(1e18f, -1e18f, 0));
}

TEST(HairFile, RefusesValuesThatAreNotFiniteInTheOtherArrays) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    // One strand of two points: segments at 128, points at 130, thickness at 154, transparency at 162, colours at 170.
    expect_in(refusal(make_hair_bytes(31, {1}).set(158, nan)), {"strand 0, vertex 1", "thickness", "nan"});
    expect_in(refusal(make_hair_bytes(31, {1}).set(166, nan)), {"strand 0, vertex 1", "transparency", "nan"});
    expect_in(refusal(make_hair_bytes(31, {1}).set(178, nan)), {"strand 0, vertex 0", "colour", "nan"});
}

TEST(HairFile, RefusesADefaultThatIsUsedAndNotFinite) {
    const float infinity = std::numeric_limits<float>::infinity();
    expect_in(refusal(make_hair_bytes(kPoints, {1}).set(20, infinity)), {"default thickness"});
    expect_in(refusal(make_hair_bytes(kPoints, {1}).set(24, infinity)), {"default transparency"});
    expect_in(refusal(make_hair_bytes(kPoints, {1}).set(32, infinity)), {"default colour"});
}

TEST(HairFile, RefusesWhatIsNoFile) {
    const TemporaryFolder folder;
    const auto refusal_of = [](const std::filesystem::path& file) -> std::string {
        try {
            read_hair(file);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::bad_input);
            return error.what();
        }
        return "was read";
    };
    expect_in(refusal_of(folder / "missing.hair"), {"missing.hair", "no such file"});
    expect_in(refusal_of(folder / "."), {"not a regular file"});
    expect_in(refusal_of("/dev/zero"), {"/dev/zero", "not a regular file"});
    std::ofstream(folder / "empty.hair").close();
    expect_in(refusal_of(folder / "empty.hair"), {"empty.hair", "0 bytes", "128"});
}

}  // namespace
}  // namespace hairbake
