#include "server/jobs/death_watch.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

using std::chrono::seconds;

class DeathWatchTest : public ::testing::Test {
protected:
    /// A worker of the stage starts and dies, a second later.
    DeathWatch::Verdict die(const std::string& stage) {
        watch.started(stage);
        time += seconds(1);
        return watch.died(stage, time);
    }
    void work(const std::string& stage) {
        watch.started(stage);
        watch.worked(stage);
    }

    DeathWatch watch{seconds(60)};
    DeathWatch::Time time{seconds(1000)};
};

TEST_F(DeathWatchTest, DeathsOfOneStageCount) {
    for (int i = 0; i < 10; ++i) EXPECT_FALSE(die("a").is_of_machine);
}

TEST_F(DeathWatchTest, DeathsOfTwoStagesAreOfTheMachineAndTheEarlierOnesAreForgiven) {
    die("a");
    die("a");
    const DeathWatch::Verdict second = die("b");
    EXPECT_TRUE(second.is_of_machine);
    EXPECT_EQ(second.stages, 2u);
    ASSERT_EQ(second.also.size(), 1u);
    EXPECT_EQ(second.also[0].stage, "a");
    EXPECT_EQ(second.also[0].deaths, 2);
    const DeathWatch::Verdict third = die("a");
    EXPECT_TRUE(third.is_of_machine);
    EXPECT_TRUE(third.also.empty());  // once
}

TEST_F(DeathWatchTest, AStageThatDiesWhileOthersWorkHasItselfToBlame) {
    die("a");
    work("good");
    EXPECT_FALSE(die("a").is_of_machine);
    EXPECT_FALSE(die("b").is_of_machine);  // the second death of "a" was its own
    work("good");
    EXPECT_FALSE(die("a").is_of_machine);
    EXPECT_FALSE(die("b").is_of_machine);
}

TEST_F(DeathWatchTest, WorkThatBeganBeforeADeathTellsNothing) {
    watch.started("old");
    die("a");
    watch.worked("old");
    EXPECT_TRUE(die("b").is_of_machine);
}

TEST_F(DeathWatchTest, DeathsFarApartAreNotOfOneTrouble) {
    die("a");
    time += seconds(60);
    EXPECT_FALSE(die("b").is_of_machine);
}

TEST_F(DeathWatchTest, PatienceWithStagesThatAlwaysDieEnds) {
    die("a");
    int forgiven = 0;
    while (die("b").is_of_machine && die("a").is_of_machine) ASSERT_LT(++forgiven, 100);
    EXPECT_EQ(forgiven, 30);  // 60 s of 2 s each
}

TEST_F(DeathWatchTest, AForgottenStageIsNoSign) {
    die("a");
    watch.forget("a");
    EXPECT_FALSE(die("b").is_of_machine);
}

TEST_F(DeathWatchTest, WithoutPatienceEachDeathCounts) {
    watch = DeathWatch(seconds(0));
    watch.died("a", time);
    EXPECT_FALSE(watch.died("b", time).is_of_machine);
}

}  // namespace
}  // namespace hairbake
