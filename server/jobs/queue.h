// The queue: states of stages and bakes, as drawn in server/README.md.
#pragma once

#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/stage_plan.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"

namespace hairbake {

/// A stage that a slot works on.
struct ClaimedStage {
    std::string key, kind, core_key, request;
    int attempt = 0;
    std::shared_ptr<std::atomic<bool>> cancel;  ///< becomes true when nobody needs the stage any more
};

struct StageFile {
    std::string name, sha256;
    std::uint64_t bytes = 0;
};

/// Why a stage or a bake failed.
struct StageError {
    std::string kind, message, field;  ///< kind as in server/worker/task.h
};

struct StageProgress {
    std::string phase;
    double fraction = 0;  ///< of the whole stage
};

struct Submitted {
    std::string id, state;
    bool already_done = false;
};

/// Thread-safe. Every change is one transaction.
class Queue {
public:
    Queue(Database& database, BlobStore& store, int max_crashes);

    /// At boot: what ran is queued again, and so are stages whose files are not all stored; inputs that are not stored
    /// are forgotten. Returns how many stages had lost a file.
    std::size_t recover();

    /// Whether the bake is done and `names` (as in BakePlan) are noted with it; then its stages count as used just now.
    bool note_done(Sql& sql, const std::string& bake, const std::string& names);

    /// Takes requests in one transaction; `batch`, when not empty, is made with them in it. Inputs were checked under
    /// database.lock(), which the caller still holds.
    std::vector<Submitted> submit(const std::vector<BakePlan>& plans, const std::string& batch = {},
                                  const std::string& batch_request = {});

    /// The next stage by priority, then age; waits for one. Nothing after stop().
    std::optional<ClaimedStage> claim();

    void progress(const std::string& key, const std::string& phase, double fraction);
    /// Fraction of running stages; nothing for others.
    std::optional<StageProgress> progress_of(const std::string& key);

    // How a claimed stage ended.
    void done(const ClaimedStage& stage, const std::vector<StageFile>& files, const std::string& manifest);
    void failed(const ClaimedStage& stage, const StageError& error);
    void died(const ClaimedStage& stage, const std::string& how);  ///< queued again, or failed after too many deaths
    void released(const ClaimedStage& stage);  ///< cancelled, or queued again when needed or stopping

    /// Throws Refusal(not_found); Refusal(conflict) when the bake has ended.
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
    void drop_unneeded(Sql& sql, const std::string& stage);
    void requeue_stage(Sql& sql, const std::string& stage);
    std::size_t requeue_incomplete(Sql& sql);
    void finish_claim(const ClaimedStage& stage);
    void wake();

    struct Running {
        std::shared_ptr<std::atomic<bool>> cancel;
        StageProgress progress;
    };

    Database& database_;
    BlobStore& store_;
    const int max_crashes_;
    std::atomic<bool> stopping_{false};
    std::mutex mutex_;  ///< of what follows; taken after the database's lock, never before
    std::condition_variable changed_;
    std::uint64_t changes_ = 0;
    std::map<std::string, Running> running_;
};

}  // namespace hairbake
