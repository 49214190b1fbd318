// What `cmake --install` puts where, and the README's first commands with it.
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "tests/clients/cli/cli.h"
#include "tests/support/source_tree.h"

namespace hairbake::test_support {
namespace {

/// The commands in the README's blocks of code from the first that begins with "hairbake", up to the first with a
/// placeholder.
std::vector<std::string> first_commands() {
    std::istringstream readme(run_program("cat " + source_file("README.md")).output);
    std::vector<std::string> commands;
    bool code = false;
    for (std::string line; std::getline(readme, line);) {
        if (line.starts_with("```")) code = !code;
        if (!code || !line.starts_with("hairbake ")) continue;
        if (contains(line, "...")) break;
        commands.push_back(line);
    }
    return commands;
}

// Relatives: the completions, the settings, and the service's programs beside the command line.
TEST(Install, PutsTheProgramOnPathWithItsCompletionsAndTheReadmesFirstCommandsWork) {
    const std::filesystem::path programs = std::filesystem::path(HAIRBAKE_PROGRAM).parent_path();
    if (!std::filesystem::exists(programs / "hairbaked") || !std::filesystem::exists(programs / "hairbake-worker"))
        GTEST_SKIP() << "the service is not built";
    const TemporaryFolder folder;
    const std::string prefix = (folder / "prefix").string();
    const Finished installed =
        run_program("cmake --install " + shell_word(programs.parent_path().string()) + " --prefix " + prefix + " 2>&1");
    ASSERT_EQ(installed.exit_code, 0) << installed.output;
    for (const char* name : {"bin/hairbake", "bin/hairbaked", "bin/hairbake-worker",
                             "share/bash-completion/completions/hairbake", "share/zsh/site-functions/_hairbake",
                             "share/fish/vendor_completions.d/hairbake.fish", "share/hairbake/config/hairbake.toml",
                             "share/hairbake/config/request.schema.json", "share/hairbake/config/openapi.json"})
        EXPECT_TRUE(std::filesystem::exists(folder / "prefix" / name)) << name;
    std::string commands = "cd " + (folder / "").string() + " && PATH=" + prefix + "/bin:$PATH";
    ASSERT_GE(first_commands().size(), 2u);
    for (const std::string& command : first_commands()) {
        const Finished run = run_program(commands + " && " + command + " 2>&1");
        EXPECT_EQ(run.exit_code, 0) << command << ": " << run.output;
    }
    EXPECT_TRUE(std::filesystem::exists(folder / "result" / "manifest.json"));
}

}  // namespace
}  // namespace hairbake::test_support
