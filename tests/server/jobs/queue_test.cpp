#include "server/jobs/queue.h"

#include <gtest/gtest.h>

#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/pruning.h"
#include "server/store/refusal.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

/// A queue without workers: the test plays them.
class QueueTest : public ::testing::Test {
protected:
    /// A bake of the stages with these keys. A stage's kind is the first letter of its key.
    static BakePlan bake(const std::string& id, const std::vector<std::string>& keys, int priority = 0) {
        BakePlan plan;
        plan.id = id;
        plan.request = "{}";
        plan.priority = priority;
        for (const std::string& key : keys) plan.stages.push_back({key.substr(0, 1), key, "core-" + key, "{}", {}});
        return plan;
    }

    void submit_batch(const std::vector<BakePlan>& plans, const std::string& id) {
        queue.submit_batch(id, "{}", [&](Sql&, const std::function<void(const BakePlan&)>& take) {
            for (const BakePlan& plan : plans) take(plan);
        });
    }

    std::string state(const std::string& table, const std::string& column, const std::string& key) {
        std::string found;
        database.read([&](Sql& sql) {
            found = sql.rows("SELECT state FROM " + table + " WHERE " + column + " = ?", {key}).at(0).text(0);
        });
        return found;
    }
    std::string bake_state(const std::string& id) { return state("bakes", "id", id); }
    std::string stage_state(const std::string& key) { return state("stages", "key", key); }

    /// The digest of a stored blob of that text.
    std::string blob_of(const std::string& text) {
        IncomingFile file(store.incoming_folder(), text.size());
        file.add(std::as_bytes(std::span(text)));
        file.finish();
        store.adopt(file.path(), file.digest(), Origin::sent);
        return file.digest();
    }

    test_support::TemporaryFolder folder;
    Database database{folder / "test.db"};
    BlobStore store{folder / "store", database};
    Queue queue{database, store, {1, 0}};
};

TEST_F(QueueTest, ABakeOfThreeStagesIsDoneAfterTheThirdAndKeepsTheirOrder) {
    queue.submit({bake("other", {"C"})});  // the shared stage is the oldest
    queue.submit({bake("a", {"A", "B", "C"})});
    database.read([&](Sql& sql) { EXPECT_EQ(stages_of(sql, "a"), (std::vector<std::string>{"A", "B", "C"})); });
    for (int i = 0; i < 3; ++i) {
        EXPECT_NE(bake_state("a"), "done");
        queue.done(*queue.claim(), {}, "{}");
    }
    EXPECT_EQ(bake_state("a"), "done");
    queue.submit({bake("b", {"A", "D", "C"})});
    queue.failed(*queue.claim(), {ErrorKind::bad_input, "broken", ""});
    EXPECT_EQ(bake_state("b"), "failed");
    EXPECT_EQ(bake_state("a"), "done");
}

TEST_F(QueueTest, ProgressNeverDecreases) {
    queue.submit({bake("a", {"T"})});
    const ClaimedStage claimed = *queue.claim();
    queue.progress("T", "one", 0.5);
    queue.progress("T", "two", 0.25);
    EXPECT_EQ(queue.progress_of("T")->phase, "two");
    EXPECT_EQ(queue.progress_of("T")->fraction, 0.5);
    queue.released(claimed);
    EXPECT_FALSE(queue.progress_of("T"));
}

TEST_F(QueueTest, ABakeIsDoneWhenBothStagesAreAndASharedStageRunsOnce) {
    queue.submit({bake("a", {"T1", "I"}), bake("b", {"T2", "I"})});
    std::vector<std::string> order;
    for (int i = 0; i < 3; ++i) {
        const ClaimedStage claimed = *queue.claim();
        order.push_back(claimed.key);
        EXPECT_EQ(bake_state("a"), i < 2 ? "running" : "done");
        queue.done(claimed, {}, "{}");
    }
    EXPECT_EQ(order, (std::vector<std::string>{"T1", "I", "T2"}));  // by age, "I" once
    EXPECT_EQ(bake_state("a"), "done");
    EXPECT_EQ(bake_state("b"), "done");
}

TEST_F(QueueTest, ABakeWhoseStagesAreStoredIsDoneAtOnce) {
    queue.submit({bake("a", {"T", "I"})});
    queue.done(*queue.claim(), {}, "{}");
    queue.done(*queue.claim(), {}, "{}");
    const Submitted again = queue.submit({bake("c", {"T", "I"})}).at(0);
    EXPECT_EQ(again.state, JobState::done);
    EXPECT_FALSE(again.already_done);
    EXPECT_TRUE(queue.submit({bake("a", {"T", "I"})}).at(0).already_done);
}

TEST_F(QueueTest, PriorityGoesBeforeAge) {
    queue.submit({bake("a", {"T1"}), bake("b", {"T2"}, 5), bake("c", {"T3"}, -5)});
    queue.submit({bake("d", {"T3"}, 10)});  // raises the stage that c waits for, too
    EXPECT_EQ(queue.claim()->key, "T3");
    EXPECT_EQ(queue.claim()->key, "T2");
    EXPECT_EQ(queue.claim()->key, "T1");
}

TEST_F(QueueTest, AFailedStageFailsItsBakesAndDropsWhatOnlyTheyNeeded) {
    queue.submit({bake("a", {"T1", "I1"}), bake("b", {"T1", "I2"}), bake("c", {"T2", "I2"})});
    queue.failed(*queue.claim(), {ErrorKind::bad_input, "broken", "hair"});
    EXPECT_EQ(bake_state("a"), "failed");
    EXPECT_EQ(bake_state("b"), "failed");
    EXPECT_EQ(bake_state("c"), "queued");
    EXPECT_EQ(stage_state("I1"), "cancelled");
    EXPECT_EQ(stage_state("I2"), "queued");   // c needs it
    queue.submit({bake("a", {"T1", "I1"})});  // asked for again
    EXPECT_EQ(bake_state("a"), "queued");
    EXPECT_EQ(stage_state("I1"), "queued");
}

TEST_F(QueueTest, CancelStopsAStageThatNobodyElseNeeds) {
    queue.submit({bake("a", {"T"}), bake("b", {"T", "I"})});
    const ClaimedStage claimed = *queue.claim();
    queue.cancel("a");
    EXPECT_FALSE(*claimed.cancel);  // b needs it
    queue.cancel("b");
    EXPECT_TRUE(*claimed.cancel);
    EXPECT_EQ(stage_state("I"), "cancelled");
    queue.released(claimed);
    EXPECT_EQ(stage_state("T"), "cancelled");
    EXPECT_THROW(queue.cancel("b"), Refusal);
    EXPECT_THROW(queue.cancel("none"), Refusal);
}

TEST_F(QueueTest, AStageThatIsAskedForWhileItIsBeingStoppedRunsAgain) {
    queue.submit({bake("a", {"T"})});
    const ClaimedStage claimed = *queue.claim();
    queue.cancel("a");
    queue.submit({bake("a", {"T"})});
    queue.released(claimed);
    EXPECT_EQ(stage_state("T"), "queued");
    EXPECT_EQ(bake_state("a"), "queued");
    EXPECT_EQ(queue.claim()->attempt, 2);
}

TEST_F(QueueTest, ADeadWorkerIsReplacedUntilItDiedTooOften) {
    queue.submit({bake("a", {"T"})});
    queue.died(*queue.claim(), "killed", true);
    EXPECT_EQ(stage_state("T"), "queued");
    queue.died(*queue.claim(), "killed", true);  // max_crashes is 1
    EXPECT_EQ(bake_state("a"), "failed");
}

TEST_F(QueueTest, WhatRanAtAKillIsQueuedAtTheNextStart) {
    queue.submit({bake("a", {"T", "I"})});
    queue.done(*queue.claim(), {}, "{}");
    queue.claim();
    Queue next(database, store, {1, 0});
    next.recover();
    EXPECT_EQ(stage_state("T"), "done");
    EXPECT_EQ(stage_state("I"), "queued");
    EXPECT_EQ(bake_state("a"), "running");  // one of its stages is done
}

TEST_F(QueueTest, AStageOfASurvivingWorkerKeepsRunningAfterARestart) {
    queue.submit({bake("a", {"T", "I"}), bake("b", {"S"})});
    const ClaimedStage claimed = *queue.claim();
    queue.claim();
    queue.started({claimed.key, "job 7", "folder"}, "farm");
    Queue next(database, store, {1, 0});
    const std::vector<StartedTask> tasks = next.started_tasks("farm");
    ASSERT_EQ(tasks.size(), 1u);
    EXPECT_TRUE(next.started_tasks("local").empty());
    next.recover(tasks);
    EXPECT_EQ(stage_state("T"), "running");
    EXPECT_EQ(stage_state("I"), "queued");
    const ClaimedStage again = *next.claim();
    EXPECT_EQ(again.key, "T");
    EXPECT_EQ(again.attempt, 1);
    EXPECT_EQ(again.started->handle, "job 7");
    EXPECT_EQ(again.started->folder, "folder");
    EXPECT_FALSE(*again.cancel);
    next.cancel("a");
    EXPECT_TRUE(*again.cancel);
    next.released(again);
    EXPECT_EQ(stage_state("T"), "cancelled");
    EXPECT_FALSE(next.claim()->started);
}

TEST_F(QueueTest, ASurvivingWorkerThatNoBakeNeedsIsToBeStopped) {
    queue.submit({bake("a", {"T"})});
    queue.started({queue.claim()->key, "job 7", "folder"}, "farm");
    queue.cancel("a");
    Queue next(database, store, {1, 0});
    next.recover(next.started_tasks("farm"));
    EXPECT_TRUE(*next.claim()->cancel);
}

TEST_F(QueueTest, WhatEndedLongAgoAndWithoutAResultIsForgotten) {
    submit_batch({bake("failed", {"T1", "I1"})}, "old batch");
    queue.failed(*queue.claim(), {ErrorKind::bad_input, "broken", "hair"});
    submit_batch({bake("live", {"T2", "I1"}), bake("done", {"T3"})}, "live batch");
    const auto count = [&](const std::string& table) {
        std::int64_t rows = 0;
        database.read([&](Sql& sql) { rows = sql.rows("SELECT count(*) FROM " + table).at(0).integer(0); });
        return rows;
    };
    prune(database, now() - 3600);  // nothing is that old
    EXPECT_EQ(count("bakes"), 3);
    prune(database, now() + 1);
    EXPECT_EQ(count("bakes"), 2);
    EXPECT_EQ(count("batches"), 1);  // of the other, no bake is left
    EXPECT_EQ(count("batch_bakes"), 2);
    EXPECT_EQ(stage_state("I1"), "queued");        // "live" needs it
    EXPECT_EQ(count("stages"), 3);                 // not T1
    queue.submit({bake("failed", {"T1", "I1"})});  // it is accepted like a new one
    EXPECT_EQ(bake_state("failed"), "queued");
}

TEST_F(QueueTest, ALostBlobStartsItsStagesAndBakesAgain) {
    queue.submit({bake("a", {"T"})});
    queue.done(*queue.claim(), {{"x.npy", std::string(64, 'a'), 1}}, "{}");
    database.write([&](Sql& sql) { queue.blob_lost(sql, std::string(64, 'a')); });
    EXPECT_EQ(bake_state("a"), "queued");
    EXPECT_EQ(queue.claim()->key, "T");
}

TEST_F(QueueTest, ALostBlobIsNotForgottenWhenItsStagesCannotBeQueuedAgain) {
    const std::string digest = blob_of("lost");
    queue.submit({bake("a", {"T"})});
    queue.done(*queue.claim(), {{"x.npy", digest, 4}}, "{}");
    std::filesystem::remove(store.path_of(digest));
    EXPECT_THROW(store.open(digest, [](Sql&) { throw std::runtime_error("the disk is full"); }), std::runtime_error);
    EXPECT_TRUE(store.size_of(digest));  // the next reader finds the loss again
    EXPECT_THROW(store.open(digest, [&](Sql& sql) { queue.blob_lost(sql, digest); }), LostBlob);
    EXPECT_FALSE(store.size_of(digest));
    EXPECT_EQ(bake_state("a"), "queued");
}

}  // namespace
}  // namespace hairbake
