// Progress and messages on terminals of all kinds; `script` of util-linux is the terminal.
#include <gtest/gtest.h>

#include <sstream>

#include "clients/cli/time_left.h"
#include "tests/clients/cli/cli.h"

namespace hairbake::test_support {
namespace {

/// What a terminal gets. `variables`: "TERM=xterm COLUMNS=40".
std::string on_terminal(const std::string& variables, const std::string& arguments) {
    const std::string command = shell_word(HAIRBAKE_PROGRAM) + " " + arguments;
    return run_program("env -u NO_COLOR -u COLUMNS -u COLORTERM " + variables + " script -qec " + shell_word(command) +
                       " /dev/null </dev/null")
        .output;
}

// Relatives: no TERM at all, no terminal.
TEST(ProgressBar, ATerminalWithoutEscapeCodesGetsNone) {
    const Workshop workshop;
    const std::string bake = workshop.quick_bake() + " --threads 1000";  // with a warning
    for (const char* variables : {"TERM=dumb", "TERM=", "-u TERM", "TERM=dumb COLORTERM=truecolor"}) {
        const std::string text = on_terminal(variables, bake);
        EXPECT_FALSE(contains(text, "\033")) << variables << ": " << text;
        EXPECT_TRUE(contains(text, "100 %")) << text;
        EXPECT_TRUE(contains(text, "warning")) << text;
    }
    EXPECT_TRUE(contains(on_terminal("TERM=xterm", bake), "\033[K"));
    EXPECT_FALSE(contains(hairbake(bake + " 2>&1").output, "\033"));
}

// Relatives: both clients' bars read COLUMNS; too narrow for a bar, and a word that is no number.
TEST(ProgressBar, FitsIntoTheColumns) {
    const Workshop workshop;
    const auto longest = [&](const std::string& columns) {
        std::string text = on_terminal("TERM=xterm COLUMNS=" + columns, workshop.quick_bake());
        std::size_t longest = 0;
        bool bar = false;
        for (std::size_t at = text.find('\r'); at != std::string::npos; at = text.find('\r', at + 1)) {
            const std::size_t end = text.find_first_of("\033\r\n", at + 1);
            longest = std::max(longest, std::min(end, text.size()) - at - 1);
            bar = bar || text[at + 1] == '[';
        }
        return std::pair(longest, bar);
    };
    EXPECT_LE(longest("40").first, 39u);
    EXPECT_TRUE(longest("40").second);
    EXPECT_LE(longest("20").first, 19u);
    EXPECT_FALSE(longest("20").second);
    EXPECT_LE(longest("many").first, 79u);
}

TEST(Messages, HaveNoColourWithNoColor) {
    const std::string wrong = "info /no/such";
    EXPECT_TRUE(contains(on_terminal("TERM=xterm", wrong), "\033["));
    EXPECT_FALSE(contains(on_terminal("TERM=xterm NO_COLOR=1", wrong), "\033"));
    EXPECT_TRUE(contains(on_terminal("TERM=xterm NO_COLOR=", wrong), "\033["));  // empty counts as not set
}

TEST(TimeLeft, NeverRisesByMoreThanATenth) {
    // Work whose second half takes ten times as long, then work that is faster than it seemed.
    for (const double slow : {10.0, 0.1}) {
        TimeLeft left;
        double last = -1;
        for (int step = 0; step <= 1000; ++step) {
            const double fraction = step / 1000.0;
            const double elapsed = 10 * (fraction < 0.5 ? fraction : 0.5 + slow * (fraction - 0.5));
            const double shown = left.update(elapsed, fraction);
            if (last > 0 && shown >= 0) {
                EXPECT_LE(shown, 1.1 * last + 1e-12) << step;
            }
            if (shown >= 0) last = shown;
        }
        EXPECT_EQ(last, 0);
    }
    TimeLeft steady;
    EXPECT_EQ(steady.update(0.1, 0.5), -1);
    EXPECT_DOUBLE_EQ(steady.update(5, 0.5), 5);
    EXPECT_DOUBLE_EQ(steady.update(6, 0.6), 4);
}

TEST(TimeLeft, IsTheSameInTheJsonLines) {
    const Workshop workshop;
    std::istringstream lines(
        hairbake(workshop.quick_bake() + " --set transmittance.method=trace --progress json").output);
    double last = -1;
    for (std::string line; std::getline(lines, line);) {
        const nlohmann::json event = nlohmann::json::parse(line);
        if (!event.contains("left_s") || event["left_s"].is_null()) continue;
        if (last > 0) {
            EXPECT_LE(event["left_s"].get<double>(), 1.1 * last + 0.011);  // two digits
        }
        last = event["left_s"];
    }
}

}  // namespace
}  // namespace hairbake::test_support
