#include "core/output/result_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "core/base/error.h"
#include "core/output/manifest.h"
#include "tests/core/output/small_result.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

namespace fs = std::filesystem;
using test_support::TemporaryFolder;

void put(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

std::string get(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Names in a folder, sorted, hidden ones too.
std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

/// A result with one file `value` of the given text.
void write_result_with(const fs::path& folder, const std::string& text) {
    ResultFolder result(folder);
    put(result.path() / "value", text);
    write_manifest(test_support::small_result(), {{"value", "", 0, {}, ""}}, result.path());
    result.commit();
}

void expect_refused(const fs::path& folder, const std::string& piece) {
    try {
        ResultFolder result(folder);
        ADD_FAILURE() << folder << " was accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_NE(std::string(error.what()).find(piece), std::string::npos) << error.what();
    }
}

using Names = std::vector<std::string>;

TEST(ResultFolder, AppearsWithCommitAndNotBefore) {
    const TemporaryFolder folder;
    {
        ResultFolder result(folder / "out");
        put(result.path() / "value", "1");
        EXPECT_FALSE(fs::exists(folder / "out"));
        result.commit();
        EXPECT_EQ(get(folder / "out" / "value"), "1");
    }
    EXPECT_EQ(names_in(folder / ""), Names{"out"});
}

TEST(ResultFolder, WithoutCommitNothingRemainsNotEvenMadeParents) {
    const TemporaryFolder folder;
    {
        ResultFolder result(folder / "a" / "b" / "out");
        put(result.path() / "value", "1");
    }
    EXPECT_TRUE(names_in(folder / "").empty());
}

TEST(ResultFolder, MakesParentsAndTakesASlashAtTheEnd) {
    const TemporaryFolder folder;
    write_result_with((folder / "a" / "out").string() + "/", "1");
    EXPECT_EQ(get(folder / "a" / "out" / "value"), "1");
}

TEST(ResultFolder, AnEmptyFolderIsFilled) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "out");
    write_result_with(folder / "out", "1");
    EXPECT_EQ(get(folder / "out" / "value"), "1");
    EXPECT_EQ(names_in(folder / ""), Names{"out"});
}

TEST(ResultFolder, AnEarlierResultIsReplacedWhole) {
    const TemporaryFolder folder;
    write_result_with(folder / "out", "1");
    write_result_with(folder / "out", "2");
    EXPECT_EQ(get(folder / "out" / "value"), "2");
    EXPECT_EQ(names_in(folder / ""), Names{"out"});
    EXPECT_EQ(names_in(folder / "out"), (Names{"manifest.json", "value"}));
}

TEST(ResultFolder, AnEarlierResultStaysWhenTheNewOneIsNotCommitted) {
    const TemporaryFolder folder;
    write_result_with(folder / "out", "1");
    { ResultFolder abandoned(folder / "out"); }
    EXPECT_EQ(get(folder / "out" / "value"), "1");
    EXPECT_EQ(names_in(folder / ""), Names{"out"});
}

TEST(ResultFolder, ForeignFilesAreNeverReplaced) {
    const TemporaryFolder folder;
    put(folder / "file", "precious");
    expect_refused(folder / "file", "is not a folder");

    fs::create_directory(folder / "foreign");
    put(folder / "foreign" / "thesis.txt", "precious");
    expect_refused(folder / "foreign", "no manifest.json");
    put(folder / "foreign" / "manifest.json", R"({"name": "a web app"})");
    expect_refused(folder / "foreign", "not hairbake's");

    write_result_with(folder / "out", "1");
    put(folder / "out" / "notes.txt", "precious");
    expect_refused(folder / "out", "notes.txt");
    EXPECT_EQ(get(folder / "out" / "notes.txt"), "precious");
}

TEST(ResultFolder, AForeignFileThatComesDuringTheBakeStopsTheCommit) {
    const TemporaryFolder folder;
    ResultFolder result(folder / "out");
    put(result.path() / "value", "1");
    fs::create_directory(folder / "out");
    put(folder / "out" / "thesis.txt", "precious");
    EXPECT_THROW(result.commit(), Error);
    EXPECT_EQ(names_in(folder / "out"), Names{"thesis.txt"});
}

TEST(ResultFolder, ACommitAfterDiscardFailsAndLeavesNothing) {
    const TemporaryFolder folder;
    {
        ResultFolder result(folder / "out");
        put(result.path() / "value", "1");
        discard_staging(folder / "out");
        EXPECT_THROW(result.commit(), Error);
    }
    EXPECT_TRUE(names_in(folder / "").empty());
    discard_staging(folder / "out");  // nothing there: no harm
}

TEST(ResultFolder, WhatAKilledProcessLeftIsCollectedAndNothingElse) {
    const TemporaryFolder folder;
    const std::string own = staging_folder(folder / "out").filename();
    const std::string prefix = own.substr(0, own.rfind('-') + 1);  // ".out.hairbake-HOST-"
    const std::string dead = prefix + "2147483647";                // above the kernel's largest process number, 2^22
    const std::string alive = prefix + "1";
    const std::string elsewhere = ".out.hairbake-another-machine-2147483647";
    const std::string other_result = ".out2" + dead.substr(4), other_file = prefix + "x";
    for (const std::string& name : {dead, dead + "-old", alive, elsewhere, other_result, other_file})
        fs::create_directory(folder / name);
    write_result_with(folder / "out", "1");
    Names expected{alive, elsewhere, other_result, other_file, "out"};
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(names_in(folder / ""), expected);
}

TEST(ResultFolder, APlaceThatCannotBeWrittenIsBadInput) {
    try {
        ResultFolder result("/proc/hairbake/out");
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::bad_input) << error.what();
    }
}

TEST(ResultFolder, ALinkToAFolderIsFollowed) {
    const TemporaryFolder folder;
    write_result_with(folder / "real", "1");
    fs::create_directory_symlink(folder / "real", folder / "link");
    write_result_with(folder / "link", "2");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_EQ(get(folder / "real" / "value"), "2");
}

}  // namespace
}  // namespace hairbake
