#include "core/environment/environment_files.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

namespace fs = std::filesystem;
using test_support::TemporaryFolder;
using Names = std::array<std::string, 6>;

const Names short_names{"px", "nx", "py", "ny", "pz", "nz"}, long_names{"posx", "negx", "posy", "negy", "posz", "negz"},
    word_names{"right", "left", "top", "bottom", "front", "back"};

// Files that hold their own names.
void make(const fs::path& folder, const Names& names, const std::string& before, const std::string& after) {
    fs::create_directories(folder);
    for (const std::string& name : names) std::ofstream(folder / (before + name + after)) << before << name << after;
}

void expect_found(const fs::path& path, const Names& names, const std::string& before, const std::string& after) {
    const EnvironmentFiles found = find_environment_files(path);
    ASSERT_EQ(found.files.size(), 6u) << path;
    for (int face = 0; face < 6; ++face)
        EXPECT_EQ(found.files[face].filename().string(), before + names[face] + after) << path;
}

void expect_refused(const fs::path& path, const std::vector<std::string>& pieces) {
    try {
        find_environment_files(path);
        ADD_FAILURE() << path << " was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input);
        EXPECT_EQ(error.field(), "environment");
        for (const std::string& piece : pieces)
            EXPECT_NE(std::string(error.what()).find(piece), std::string::npos)
                << '"' << piece << "\" is not in: " << error.what();
    }
}

TEST(EnvironmentFiles, AFolderHoldsSixFacesUnderAnyOfTheNames) {
    const TemporaryFolder folder;
    make(folder / "a", short_names, "", ".hdr");
    expect_found(folder / "a", short_names, "", ".hdr");
    make(folder / "b", long_names, "sky_", ".exr");
    expect_found(folder / "b", long_names, "sky_", ".exr");
    make(folder / "c", word_names, "A sky at noon - ", ".PNG");
    expect_found(folder / "c", word_names, "A sky at noon - ", ".PNG");
    const Names upper{"PX", "NX", "PY", "NY", "PZ", "NZ"};
    make(folder / "d", upper, "x.", ".tif");
    expect_found(folder / "d", upper, "x.", ".tif");
}

TEST(EnvironmentFiles, OtherFilesOfTheFolderArePassedOver) {
    const TemporaryFolder folder;
    make(folder / "a", short_names, "sky_", ".hdr");
    make(folder / "a", {"readme.txt", "preview.png", "px.blend", "topping.hdr", "sky_mirrorpx.hdr", "notes"}, "", "");
    fs::create_directory(folder / "a" / "px.hdr");
    expect_found(folder / "a", short_names, "sky_", ".hdr");
}

TEST(EnvironmentFiles, APatternChoosesAmongSets) {
    const TemporaryFolder folder;
    make(folder / "a", short_names, "day_", ".hdr");
    make(folder / "a", word_names, "night", "_2k.hdr");
    expect_found(folder / "a" / "day_{face}.hdr", short_names, "day_", ".hdr");
    expect_found(folder / "a" / "night{face}_2k.hdr", word_names, "night", "_2k.hdr");
    fs::current_path(folder / "a");  // without a folder before it
    expect_found("day_{face}.hdr", short_names, "day_", ".hdr");
    fs::current_path("/");
}

TEST(EnvironmentFiles, AFileIsAFileWhateverItsName) {
    const TemporaryFolder folder;
    std::ofstream(folder / "sky_{face}.hdr") << "x";
    EXPECT_EQ(find_environment_files(folder / "sky_{face}.hdr").files.size(), 1u);
    EXPECT_EQ(find_environment_files(folder / "missing.hdr").files.size(), 1u);  // its reader says that it is missing
}

TEST(EnvironmentFiles, WhatIsMissingIsListed) {
    const TemporaryFolder folder;
    make(folder / "a", short_names, "sky_", ".hdr");
    fs::remove(folder / "a" / "sky_ny.hdr");
    for (const fs::path& path : {folder / "a", folder / "a" / "sky_{face}.hdr"})
        expect_refused(
            path, {"looked for", "px nx py ny pz nz", "right left top bottom front back",
                   "\"sky_{face}.hdr\": found sky_px.hdr sky_nx.hdr sky_py.hdr sky_pz.hdr sky_nz.hdr; missing ny"});
    fs::create_directory(folder / "empty");
    expect_refused(folder / "empty", {"no faces of a cube map", "looked for"});
    expect_refused(folder / "a" / "{face}.exr", {"no faces of a cube map"});
    expect_refused(folder / "nowhere" / "{face}.exr", {"there is no folder"});
    expect_refused(folder / "a" / "{face}_{face}.exr", {"twice"});
}

TEST(EnvironmentFiles, WhatIsAmbiguousIsListed) {
    const TemporaryFolder folder;
    make(folder / "two", short_names, "day_", ".hdr");
    make(folder / "two", short_names, "night_", ".hdr");
    expect_refused(folder / "two", {"2 sets of six faces", "\"day_{face}.hdr\"", "\"night_{face}.hdr\"", "pattern"});
    make(folder / "kinds", short_names, "", ".hdr");
    make(folder / "kinds", word_names, "", ".hdr");
    expect_refused(folder / "kinds" / "{face}.hdr", {"2 sets of six faces"});
    make(folder / "case", short_names, "", ".hdr");
    std::ofstream(folder / "case" / "PX.hdr") << "x";
    expect_refused(folder / "case", {"no set of six faces is complete, with one file a face", "PX.hdr"});
    make(folder / "mixed", {"px", "nx", "py", "bottom", "front", "back"}, "", ".hdr");
    expect_refused(folder / "mixed", {"missing ny pz nz", "missing right left top"});
}

TEST(EnvironmentFiles, TheMessageStaysShortHoweverManyFilesThereAre) {
    const TemporaryFolder folder;
    fs::create_directories(folder / "many");
    for (int i = 0; i < 300; ++i) std::ofstream(folder / "many" / ("sky" + std::to_string(i) + "_px.hdr")) << "x";
    expect_refused(folder / "many", {"and 294 more sets"});
}

TEST(EnvironmentFiles, TheDigestIsThatOfTheBytesInTheOrderOfTheFaces) {
    const TemporaryFolder folder;
    make(folder / "a", short_names, "", ".hdr");
    std::ofstream(folder / "one.hdr") << "one";
    EXPECT_EQ(digest_of_environment(folder / "one.hdr"), digest_of_file(folder / "one.hdr"));

    Digest expected;
    expected.add("hairbake cube faces\n");
    for (const std::string& name : short_names) expected.add(digest_of_file(folder / "a" / (name + ".hdr")) + "\n");
    const std::string digest = digest_of_environment(folder / "a");
    EXPECT_EQ(digest, expected.hex());
    EXPECT_EQ(digest_of_environment(folder / "a" / "{face}.hdr"), digest);

    fs::create_directories(folder / "b");  // other names, the same bytes
    for (int face = 0; face < 6; ++face)
        fs::copy_file(folder / "a" / (short_names[face] + ".hdr"), folder / "b" / (word_names[face] + ".exr"));
    EXPECT_EQ(digest_of_environment(folder / "b"), digest);
    fs::rename(folder / "b" / "top.exr", folder / "b" / "x");
    fs::rename(folder / "b" / "left.exr", folder / "b" / "top.exr");
    fs::rename(folder / "b" / "x", folder / "b" / "left.exr");
    EXPECT_NE(digest_of_environment(folder / "b"), digest) << "two faces changed places";
}

}  // namespace
}  // namespace hairbake
