#include "server/jobs/stage_deaths.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

TEST(StageDeaths, WaitsGrowFasterWhenTheyCameFromOutside) {
    const DeathRules rules{5, 2};
    const double outside[]{2, 8, 32, 128, 512, 600, 600}, inside[]{2, 4, 8, 16, 32, 64, 128};
    for (std::size_t i = 0; i < 7; ++i) {
        EXPECT_EQ(wait_after_deaths(rules, i + 1, true), outside[i]);
        EXPECT_EQ(wait_after_deaths(rules, i + 1, false), inside[i]);
    }
    EXPECT_EQ(wait_after_deaths(rules, 1000, true), 600);
    EXPECT_EQ(wait_after_deaths({5, 0}, 3, true), 0);
}

TEST(StageDeaths, TheColumnKeepsThem) {
    EXPECT_TRUE(read_deaths("").empty());
    const auto read = read_deaths(deaths_json({{1.5, "killed", true}, {2, "\"crashed\"", false}}));
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[0].time, 1.5);
    EXPECT_EQ(read[0].how, "killed");
    EXPECT_TRUE(read[0].from_outside);
    EXPECT_EQ(read[1].how, "\"crashed\"");
    EXPECT_FALSE(read[1].from_outside);
}

TEST(StageDeaths, TheFailureSaysHowOftenHowAndWhatToDo) {
    const std::string killed =
        words_for_failure({{10, "killed", true}, {20, "crashed", false}, {70, "killed", true}}, {2, 1});
    EXPECT_EQ(killed,
              "workers of this stage died 3 times within 60 s (once: crashed; 2 times: killed); allowed are 2 deaths "
              "([workers] max_crashes). The system ends processes with SIGKILL when memory is short: look at the "
              "machine's memory and its log, then submit the request again");
    EXPECT_EQ(words_for_failure({{10, "crashed", false}}, {0, 1}),
              "workers of this stage died once (once: crashed); allowed are 0 deaths ([workers] max_crashes). A trial "
              "without the input worked, so the input or the request is probably at fault: check them, then submit the "
              "request again");
}

}  // namespace
}  // namespace hairbake
