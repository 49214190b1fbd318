// The queue: states of stages and bakes. docs/architecture.md draws the transitions.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/bake_records.h"
#include "server/jobs/death_watch.h"
#include "server/jobs/job_state.h"
#include "server/jobs/queue_pause.h"
#include "server/jobs/stage_deaths.h"
#include "server/jobs/stage_plan.h"

namespace hairbake {

class BlobStore;
class Database;
class Sql;

/// A worker that runs without the daemon that started it.
struct StartedTask {
    std::string stage;   ///< key
    std::string handle;  ///< of the runner
    std::string folder;  ///< name of the work folder in the store's folder for incoming files
};

/// A stage that a thread of the worker pool works on.
struct ClaimedStage {
    std::string key, kind, core_key, request;
    int attempt = 0;
    std::shared_ptr<std::atomic<bool>> cancel;  ///< becomes true when no live bake needs the stage any more
    std::optional<StartedTask> started = {};    ///< the running worker to follow, instead of starting one
};

struct StageFile {
    std::string name, sha256;
    std::uint64_t bytes = 0;
};

struct StageProgress {
    std::string phase;
    double fraction = 0;  ///< of the whole stage; never decreases while the stage runs
};

struct Submitted {
    std::string id;
    JobState state = JobState::queued;
    bool already_done = false;
};

/// Thread-safe. Every change is one transaction.
class Queue {
public:
    Queue(Database& database, BlobStore& store, const DeathRules& rules);

    /// The running stages whose handles are of the runner of that name.
    std::vector<StartedTask> started_tasks(const std::string& runner);

    struct Recovered {
        std::size_t lost = 0;           ///< stages that had lost a file
        std::size_t planned_again = 0;  ///< stages that another version of hairbake had queued
    };
    /// At boot. Stages of `surviving` workers stay running. Other running stages are queued again, and so are stages
    /// whose files are not all stored. Stages whose workers died go on waiting. A stage that ran when n >= 2 daemons
    /// ended waits as after n - 1 deaths. Inputs that are not stored are forgotten. Queued stages of another version of
    /// hairbake are planned again; their bakes keep their ids.
    Recovered recover(const std::vector<StartedTask>& surviving = {});

    /// Whether the bake is done and `names` (as in BakePlan) are noted with it; then its stages count as used just now.
    bool note_done(Sql& sql, const std::string& bake, const std::string& names);

    /// Takes requests in one transaction. The caller checked the inputs under database.lock() and still holds it.
    std::vector<Submitted> submit(const std::vector<BakePlan>& plans);

    /// Calls its argument with each plan of a batch. Plans are made one at a time: a batch can have 100,000.
    using EachPlan = std::function<void(Sql& sql, const std::function<void(const BakePlan&)>& take)>;
    /// Makes the batch `id` and takes its requests in one transaction, in which `each_plan` makes the plans. What it
    /// throws undoes everything. `request` is JSON.
    void submit_batch(const std::string& id, const std::string& request, const EachPlan& each_plan);

    /// The next stage by priority, then age; blocks until there is one and it may be tried (queue_pause.h). A stage
    /// that was queued by another version of hairbake is planned again first. Nothing after stop().
    std::optional<ClaimedStage> claim();

    /// Stores the handle of a worker that survives a restart of the daemon.
    void started(const StartedTask& task, const std::string& runner);

    void progress(const std::string& key, const std::string& phase, double fraction);
    /// Nothing for a stage that does not run.
    std::optional<StageProgress> progress_of(const std::string& key);

    // How a claimed stage ended.
    void done(const ClaimedStage& stage, const std::vector<StageFile>& files, const std::string& manifest);
    void failed(const ClaimedStage& stage, const StageError& error);
    /// A death that counts against the stage: queues it again, to wait longer after each; fails it after too many.
    void died(const ClaimedStage& stage, const std::string& how, bool from_outside);
    /// The reason when the machine is at fault for a death from outside (death_watch.h), as an operator should know it.
    /// Call it once for each, before pause() or died(). Earlier deaths that it explains are forgiven.
    std::optional<std::string> trouble_in_death(const ClaimedStage& stage, const std::string& how);
    /// Queues the stage again when a live bake needs it; else cancels it.
    void released(const ClaimedStage& stage);
    /// The machine was at fault, as told to pause(): like released(), and the attempt does not count.
    void given_back(const ClaimedStage& stage);

    /// The machine is in trouble: pauses the queue. `stage` is the key of the stage that met the trouble, or empty.
    void pause(const std::string& stage, const std::string& reason);

    struct Pause {
        std::string reason;          ///< empty: the queue is not paused
        double next_try_s = 0;       ///< seconds from now; at least 0
        std::uint64_t troubles = 0;  ///< since the start
    };
    Pause paused();
    /// The trouble that a queued stage waits for: the last one that it met itself, or that of the queue; or empty.
    std::string trouble_of(const std::string& stage);

    /// Whether results of later bakes that have not ended hold `bytes` that the stage lacks. Bakes come in the order of
    /// the queue: by priority, then age. Without this, bakes that each have a part of their results would wait for each
    /// other's room for ever.
    bool can_give_way(const std::string& stage, std::uint64_t bytes);
    /// Removes such results, those of the latest bakes first, and queues their stages again. Removes nothing and
    /// returns false where they hold less. The caller holds database.lock() until it has used the room.
    bool make_others_give_way(const std::string& stage, std::uint64_t bytes);

    /// Throws Refusal(not_found or gone).
    /// Throws Refusal(conflict) when the bake has ended.
    void cancel(const std::string& bake);

    /// A blob is gone: stages that wrote it are queued again with their bakes, in the transaction that forgets it.
    void blob_lost(Sql& sql, const std::string& digest);

    void stop();
    bool stopping() const { return stopping_; }

private:
    void touch_stage(Sql& sql, const std::string& stage);
    void add_stage(Sql& sql, const StagePlan& stage, int priority);
    Submitted add_bake(Sql& sql, const BakePlan& plan);
    void settle_bake(Sql& sql, const std::string& bake);
    void settle_bakes_of(Sql& sql, const std::string& stage);
    void fail_stage(Sql& sql, const std::string& stage, const StageError& error);
    void drop_unneeded(Sql& sql, const std::string& stage);
    void release_stage(Sql& sql, const std::string& stage);
    void requeue_stage(Sql& sql, const std::string& stage);
    std::size_t requeue_incomplete(Sql& sql);
    bool plan_again(Sql& sql, const std::string& stage);
    std::size_t plan_queued_again(Sql& sql);
    void resume(Sql& sql, const StartedTask& task);
    std::optional<ClaimedStage> claim_queued();
    std::optional<ClaimedStage> try_to_claim();
    std::string next_stage(Sql& sql);
    void finish_claim(const ClaimedStage& stage);
    std::vector<StageDeath> add_death(Sql& sql, const std::string& stage, const StageDeath& death);
    void forgive(const std::vector<DeathWatch::Forgiven>& stages);
    void hold_after_deaths(Sql& sql);
    void hold_after_ends(const std::string& stage, int ends);
    void end_well(const ClaimedStage& stage);
    void wake();

    struct Running {
        std::shared_ptr<std::atomic<bool>> cancel;
        StageProgress progress;
    };

    Database& database_;
    BlobStore& store_;
    const DeathRules rules_;
    std::atomic<bool> stopping_{false};
    std::mutex mutex_;  ///< guards the members below; taken after the database's lock, never before
    std::condition_variable changed_;
    std::uint64_t changes_ = 0;
    std::map<std::string, Running> running_;
    std::deque<ClaimedStage> resumed_;  ///< of surviving workers; to be claimed first
    QueuePause pause_;
    DeathWatch watch_;
};

}  // namespace hairbake
