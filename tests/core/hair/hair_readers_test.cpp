// The choice of a reader, and the promises that every reader makes.
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "core/base/error.h"
#include "core/hair/hair_file.h"
#include "core/hair/hair_reader.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tfx_bytes.h"

namespace hairbake {
namespace {

using namespace hairbake::test_support;

std::string refusal(std::span<const std::byte> file, const std::string& name) {
    try {
        read_groom(file, name);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        return error.what();
    }
    return "was read";
}

void write(const std::filesystem::path& file, const HairBytes& bytes) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.bytes.data()), static_cast<std::streamsize>(bytes.bytes.size()));
}

TEST(HairReaders, TheFirstBytesDecideWhateverTheName) {
    EXPECT_EQ(read_groom(make_tfx_bytes(4, 2, 4), "misnamed.hair").model.format, "TressFX 4.0");
    EXPECT_EQ(read_groom(make_hair_bytes(31, {2, 1}), "misnamed.tfx").model.format, "HAIR");
    const TemporaryFolder folder;
    write(folder / "no_extension", make_tfx_bytes(3, 2, 4));
    EXPECT_EQ(read_groom(folder / "no_extension").model.format, "TressFX 3.0");
    EXPECT_TRUE(is_hair_file(folder / "no_extension"));
    write(folder / "sky.hdr", make_hair_bytes(31, {2, 1}));
    EXPECT_TRUE(is_hair_file(folder / "sky.hdr"));
}

TEST(HairReaders, AFileOfNoFormatIsRefusedByTheReaderThatItsExtensionNames) {
    HairBytes file = make_tfx_bytes(4, 2, 4);
    file.set(0, 5.0f);  // the bytes 00 00 a0 40
    EXPECT_NE(refusal(file, "a.tfx").find("header, version"), std::string::npos);
    EXPECT_NE(refusal(file, "a.TFX").find("header, version"), std::string::npos);
    for (const char* name : {"a.hair", "a.HAIR", "a.abc", "a"}) {
        const std::string message = refusal(file, name);
        EXPECT_EQ(message.find(std::string(name) + ": this is no hair model"), 0u) << message;
        EXPECT_NE(message.find("00 00 a0 40"), std::string::npos) << message;
        EXPECT_NE(message.find("\"HAIR\""), std::string::npos) << message;
        EXPECT_NE(message.find("TressFX"), std::string::npos) << message;
    }
    file.bytes.resize(2);
    EXPECT_NE(refusal(file, "a").find("the first bytes are 00 00;"), std::string::npos);
    EXPECT_NE(refusal({}, "a").find("the first bytes are nothing;"), std::string::npos);
    const TemporaryFolder folder;
    write(folder / "a.Tfx", file);
    write(folder / "a", file);
    EXPECT_TRUE(is_hair_file(folder / "a.Tfx"));
    EXPECT_FALSE(is_hair_file(folder / "a"));
    EXPECT_THROW(is_hair_file(folder / "missing.hair"), Error);
}

TEST(HairReaders, HaveNamesAndExtensionsOfTheirOwn) {
    std::set<std::string_view> names, extensions;
    for (const HairReader* reader : hair_readers()) {
        EXPECT_TRUE(names.insert(reader->name).second) << reader->name;
        EXPECT_TRUE(extensions.insert(reader->extension).second) << reader->extension;
        EXPECT_TRUE(reader->extension.starts_with('.')) << reader->extension;
        EXPECT_FALSE(reader->recognises({})) << reader->name;
    }
}

TEST(HairReaders, AFormatWithoutAnimationWarnsOfATimeThatIsNotZero) {
    for (const HairBytes& file : {make_hair_bytes(31, {2, 1}), make_tfx_bytes(3, 2, 4)}) {
        EXPECT_TRUE(read_groom(file, "still").warnings.empty());
        HairReadSettings settings;
        settings.time = 1.5;
        const Groom groom = read_groom(file, "still", settings);
        ASSERT_EQ(groom.warnings.size(), 1u);
        EXPECT_NE(groom.warnings[0].find("strand.time is 1.5 seconds"), std::string::npos) << groom.warnings[0];
        EXPECT_EQ(groom.model.positions, read_groom(file, "still").model.positions);
    }
}

}  // namespace
}  // namespace hairbake
