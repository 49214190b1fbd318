#include "server/settings.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/base/error.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

class SettingsTest : public ::testing::Test {
protected:
    Settings read(const std::string& text) {
        std::ofstream(folder / "a.toml") << text;
        return read_settings(folder / "a.toml");
    }
    test_support::TemporaryFolder folder;
};

TEST_F(SettingsTest, TheDocumentedFileHasEveryDefault) {
    const Settings from_file = read_settings(HAIRBAKE_CONFIG), defaults;
    EXPECT_EQ(from_file.port, defaults.port);
    EXPECT_EQ(from_file.threads, defaults.threads);
    EXPECT_EQ(from_file.waiting, defaults.waiting);
    EXPECT_EQ(from_file.bodies, defaults.bodies);
    EXPECT_EQ(from_file.bodies_per_address, defaults.bodies_per_address);
    EXPECT_EQ(from_file.body_rate, defaults.body_rate);
    EXPECT_EQ(from_file.body_window_s, defaults.body_window_s);
    EXPECT_EQ(from_file.budget_bytes, defaults.budget_bytes);
    EXPECT_EQ(from_file.keep_free_bytes, defaults.keep_free_bytes);
    EXPECT_EQ(from_file.blob_bytes, defaults.blob_bytes);
    EXPECT_EQ(from_file.upload_lifetime_s, defaults.upload_lifetime_s);
    EXPECT_EQ(from_file.open_uploads, defaults.open_uploads);
    EXPECT_EQ(from_file.keep_failed_s, defaults.keep_failed_s);
    EXPECT_EQ(from_file.memory_bytes, defaults.memory_bytes);
    EXPECT_EQ(from_file.cpu_seconds, defaults.cpu_seconds);
    EXPECT_EQ(from_file.wall_seconds, defaults.wall_seconds);
    EXPECT_EQ(from_file.runner, defaults.runner);
    EXPECT_EQ(from_file.max_crashes, defaults.max_crashes);
    EXPECT_EQ(from_file.crash_wait_s, defaults.crash_wait_s);
}

TEST_F(SettingsTest, ReadsTokensAndPaths) {
    const Settings settings =
        read("[store]\nfolder = \"x\"\n[[token]]\nname = \"a\"\nsha256 = \"" + std::string(64, '0') +
             "\"\nscopes = [\"read\"]\nexpires = 1970-01-02T01:00:00+01:00\n");
    EXPECT_EQ(settings.store, folder / "x");
    ASSERT_EQ(settings.tokens.size(), 1u);
    EXPECT_EQ(settings.tokens[0].scopes, std::set<Scope>{Scope::read});
    EXPECT_EQ(settings.tokens[0].expires, 86400);  // midnight UTC after one day
}

TEST_F(SettingsTest, RefusesWhatIsNotAllowedByName) {
    for (const auto& [text, field] : {std::pair("[listen]\nport = 70000", "listen.port"),
                                      {"[listen]\nprt = 1", "listen.prt"},
                                      {"[listen]\nport = \"80\"", "listen.port"},
                                      {"[colour]\nx = 1", "colour"},
                                      {"[[token]]\nname = \"a\"\nscopes = [\"all\"]", "token.scopes"}})
        try {
            read(text);
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.field(), field);
        }
    Settings settings;
    settings.address = "0.0.0.0";
    settings.worker = "/bin/true";
    EXPECT_THROW(complete(settings), Error);
    settings.address = "127.0.0.1";
    settings.runner = "farm";
    try {
        complete(settings);
        ADD_FAILURE() << "an unknown runner was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.field(), "workers.runner");
    }
}

}  // namespace
}  // namespace hairbake
