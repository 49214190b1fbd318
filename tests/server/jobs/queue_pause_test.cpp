#include "server/jobs/queue_pause.h"

#include <gtest/gtest.h>

namespace hairbake {
namespace {

using std::chrono::seconds;

/// Plays a queue with a clock of its own.
class QueuePauseTest : public ::testing::Test {
protected:
    bool may_try() const { return pause.next_try(time) <= time; }
    void try_stage(const std::string& stage) {
        pause.begin_try(time);
        pause.claimed(stage);
    }
    /// Seconds until the next try.
    std::int64_t wait() const { return std::chrono::duration_cast<seconds>(pause.next_try(time) - time).count(); }

    QueuePause pause;
    QueuePause::Time time{seconds(1000)};
};

TEST_F(QueuePauseTest, WaitsDoubleUpToTheLongest) {
    for (const std::int64_t expected : {1, 2, 4, 8, 16, 30, 30}) {
        EXPECT_TRUE(may_try());
        try_stage("a");
        pause.met_trouble("a", "the disk is full", time);
        EXPECT_EQ(wait(), expected);
        EXPECT_EQ(pause.reason(), "the disk is full");
        time += seconds(expected);
    }
    try_stage("a");
    pause.worked("a");
    EXPECT_EQ(pause.reason(), "");
    EXPECT_TRUE(may_try());
    try_stage("a");
    pause.met_trouble("a", "again", time);
    EXPECT_EQ(wait(), 1);  // the troubles before were over
    EXPECT_EQ(pause.troubles(), 8u);
}

TEST_F(QueuePauseTest, OneStageIsTriedAtATime) {
    pause.met_trouble("a", "no processes", time);
    EXPECT_FALSE(may_try());
    time += seconds(1);
    try_stage("b");
    EXPECT_EQ(wait(), 10);                         // beside a probe that runs for so long
    pause.met_trouble("c", "no processes", time);  // started before the pause: shows nothing new
    EXPECT_EQ(wait(), 10);
    pause.worked("d");  // likewise
    EXPECT_EQ(pause.reason(), "no processes");
    time += seconds(10);
    try_stage("e");
    EXPECT_FALSE(may_try());
    pause.worked("b");  // the first probe, late
    EXPECT_EQ(pause.reason(), "");
    EXPECT_TRUE(may_try());
}

TEST_F(QueuePauseTest, AStageThatMetATroubleWaitsItselfWhileOthersWork) {
    pause.met_trouble("a", "its input cannot be read", time);
    EXPECT_EQ(pause.first_end(time), time + seconds(1));
    time += seconds(1);
    EXPECT_EQ(pause.held(time).count("a"), 0u);
    try_stage("a");
    pause.met_trouble("a", "its input cannot be read", time);
    time += seconds(1);
    EXPECT_EQ(pause.held(time).count("a"), 1u);
    time += seconds(1);
    try_stage("b");
    pause.worked("b");
    EXPECT_EQ(pause.reason(), "");
    EXPECT_EQ(pause.reason_of("a"), "its input cannot be read");
    EXPECT_EQ(pause.troubles_of("a"), 2);
    EXPECT_EQ(pause.troubles_of("b"), 0);
    try_stage("a");
    pause.met_trouble("a", "its input cannot be read", time);  // its own: others have worked
    EXPECT_EQ(pause.reason(), "");
    EXPECT_TRUE(may_try());
    EXPECT_EQ(pause.first_end(time), time + seconds(4));
    time += seconds(4);
    try_stage("a");
    pause.met_trouble("a", "its input cannot be read", time);  // none has worked since
    EXPECT_EQ(wait(), 1);
    pause.worked("a");
    EXPECT_EQ(pause.reason_of("a"), "");
    EXPECT_EQ(pause.first_end(time), QueuePause::Time::max());
}

TEST_F(QueuePauseTest, ACancelledProbeMakesRoomForTheNext) {
    pause.met_trouble("a", "no worker program", time);
    time += seconds(1);
    try_stage("b");
    EXPECT_FALSE(may_try());
    pause.ended("b", time);
    EXPECT_TRUE(may_try());
    EXPECT_EQ(pause.reason(), "no worker program");
    pause.clear();  // nothing is queued
    EXPECT_EQ(pause.reason(), "");
}

TEST_F(QueuePauseTest, AClaimThatFailsIsAFailedTry) {
    pause.met_trouble("", "the database cannot be written", time);
    time += seconds(1);
    pause.begin_try(time);
    pause.met_trouble("", "the database cannot be written", time);
    EXPECT_EQ(wait(), 2);
    EXPECT_EQ(pause.first_end(time), QueuePause::Time::max());  // no stage waits
}

}  // namespace
}  // namespace hairbake
