// The completion scripts, run by their shells.
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "tests/clients/cli/cli.h"

namespace hairbake::test_support {
namespace {

bool has_program(const std::string& name) { return run_program("command -v " + name).exit_code == 0; }

/// The names of the options that a help lists: "  --hair FILE  hair model", "  -h,--help  ...".
std::set<std::string> options_in(const std::string& help) {
    std::set<std::string> found;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t at = line.find("--");
        if (!line.starts_with("  -") || at > 5) continue;
        found.insert(line.substr(at, line.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at + 2) - at));
    }
    return found;
}

const char* const commands[] = {"bake",   "info", "sample", "compare", "render",     "diff",   "presets", "submit",
                                "status", "wait", "fetch",  "cancel",  "completion", "rebake", "upload",  "delete"};

TEST(Completion, KnowsEveryCommandAndOptionOfTheHelp) {
    for (const std::string shell : {"bash", "zsh", "fish"}) {
        const std::string script = hairbake("completion " + shell).output;
        for (const std::string command : commands) {
            EXPECT_TRUE(contains(script, command)) << shell << ' ' << command;
            const std::set<std::string> options = options_in(hairbake(command + " --help").output);
            EXPECT_TRUE(options.contains("--help")) << command;
            for (const std::string& option : options)
                EXPECT_TRUE(contains(script, shell == "fish" ? "-l " + option.substr(2) : option))
                    << shell << ' ' << command << ' ' << option;
        }
    }
    EXPECT_EQ(hairbake("completion csh 2>&1").exit_code, 2);
    EXPECT_TRUE(contains(hairbake("completion csh 2>&1").output, "bash, zsh, fish"));
}

/// What bash offers after these words.
std::string bash_offers(const std::string& words) {
    return run_program("bash -c 'source <(" + shell_word(HAIRBAKE_PROGRAM) + " completion bash); cd / && COMP_WORDS=(" +
                       words +
                       "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _hairbake 2>/dev/null; echo \"${COMPREPLY[*]}\"'")
        .output;
}

// Relatives of the option: its values, values behind "=", fields and their words, lists, files, folders, arguments.
TEST(Completion, BashOffersWhatFits) {
    for (const auto& [words, expected] : {std::pair("hairbake co", "compare completion\n"),
                                          {"hairbake bake --pro", "--progress\n"},
                                          {"hairbake bake --progress j", "json\n"},
                                          {"hairbake bake --progress = j", "json\n"},
                                          {"hairbake bake --set transmittance.meth", "transmittance.method=\n"},
                                          {"hairbake bake --set transmittance.method = tr", "trace\n"},
                                          {"hairbake bake --outputs npy,e", "npy,exr\n"},
                                          {"hairbake bake --preset pa", "paper\n"},
                                          {"hairbake presets pa", "paper\n"},
                                          {"hairbake bake --hair etc/passw", "etc/passwd etc/passwd-\n"},
                                          {"hairbake info etc/hostnam", "etc/hostname\n"},
                                          {"hairbake bake --out etc/sys", "etc/sysctl.d etc/systemd\n"},
                                          {"hairbake completion f", "fish\n"},
                                          {"hairbake render --mode br", "brute\n"},
                                          {"hairbake status --state ru", "running\n"},
                                          {"hairbake wait --batch a", "\n"}}) {
        const std::string found = bash_offers(words);
        if (contains(words, "etc/"))  // of this machine: the first is always there
            EXPECT_TRUE(contains(found, std::string(expected).substr(0, std::string(expected).find_first_of(" \n"))) ||
                        !std::filesystem::exists("/etc/hostname") || contains(words, "sys"))
                << words << ": " << found;
        else
            EXPECT_EQ(found, expected) << words;
    }
}

TEST(Completion, FishOffersWhatFits) {
    if (!has_program("fish")) GTEST_SKIP() << "fish is not installed";
    const TemporaryFolder home;
    const auto offers = [&](const std::string& line) {
        return run_program("HOME=" + (home / "").string() + " fish -c '" + shell_word(HAIRBAKE_PROGRAM) +
                           " completion fish | source; complete -C \"" + line + "\"' | cut -f1")
            .output;
    };
    EXPECT_EQ(offers("hairbake co"), "compare\ncompletion\n");
    EXPECT_EQ(offers("hairbake bake --progress "), "auto\njson\nnone\n");
    EXPECT_TRUE(contains(offers("hairbake bake --set transmittance.method="), "transmittance.method=trace\n"));
    EXPECT_TRUE(contains(offers("hairbake bake --outputs npy,e"), "npy,exr\n"));
    EXPECT_EQ(offers("hairbake bake --resul"), "");
}

TEST(Completion, ZshTakesTheScript) {
    if (!has_program("zsh")) GTEST_SKIP() << "zsh is not installed";
    const TemporaryFolder home;
    const std::string script = (home / "_hairbake").string();
    ASSERT_EQ(hairbake("completion zsh >" + script).exit_code, 0);
    const Finished loaded =
        run_program("cd " + (home / "").string() +
                    " && HOME=$PWD zsh -f -c 'fpath=($PWD $fpath); autoload -U "
                    "compinit; compinit -u -d $PWD/dump; print $_comps[hairbake]; zsh -n _hairbake' 2>&1");
    EXPECT_EQ(loaded.exit_code, 0);
    EXPECT_EQ(loaded.output, "_hairbake\n");
}

}  // namespace
}  // namespace hairbake::test_support
