// How the states of stages and bakes follow from each other.
#include <algorithm>

#include "server/jobs/queue.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/refusal.h"

namespace hairbake {

/// Derives a live bake's state from those of its stages.
void Queue::settle_bake(Sql& sql, const std::string& bake) {
    const auto stages = sql.rows(
        "SELECT s.key, s.state, s.error FROM bakes b JOIN bake_stages m ON m.bake = b.seq JOIN stages s ON s.key = "
        "m.stage WHERE b.id = ? AND b.state IN ('queued', 'running') ORDER BY m.seq",
        {bake});
    if (stages.empty()) return;
    const auto is = [](JobState state) {
        return [state](const SqlRow& row) { return job_state(row.text(1)) == state; };
    };
    const auto broken = std::find_if(stages.begin(), stages.end(), is(JobState::failed));
    if (broken != stages.end()) {
        sql.run("UPDATE bakes SET state = 'failed', error = ?, finished = ? WHERE id = ?",
                {broken->text(2), now(), bake});
        for (const SqlRow& stage : stages) drop_unneeded(sql, stage.text(0));
    } else if (std::all_of(stages.begin(), stages.end(), is(JobState::done))) {
        sql.run("UPDATE bakes SET state = 'done', finished = ? WHERE id = ?", {now(), bake});
    } else {
        const bool begun = std::any_of(stages.begin(), stages.end(), is(JobState::running)) ||
                           std::any_of(stages.begin(), stages.end(), is(JobState::done));
        sql.run("UPDATE bakes SET state = ? WHERE id = ?",
                {name_of(begun ? JobState::running : JobState::queued), bake});
    }
}

void Queue::settle_bakes_of(Sql& sql, const std::string& stage) {
    for (const std::string& bake : live_bakes_of(sql, stage)) settle_bake(sql, bake);
}

/// Cancels a live stage that no live bake needs.
void Queue::drop_unneeded(Sql& sql, const std::string& stage) {
    if (is_needed(sql, stage)) return;
    const int waiting = sql.run("UPDATE stages SET state = 'cancelled' WHERE key = ? AND state = 'queued'", {stage});
    const std::lock_guard lock(mutex_);
    if (waiting > 0) {
        pause_.forget(stage);
        watch_.forget(stage);
    }
    if (const auto running = running_.find(stage); running != running_.end()) *running->second.cancel = true;
}

void Queue::release_stage(Sql& sql, const std::string& stage) {
    sql.run("UPDATE stages SET state = ? WHERE key = ?",
            {name_of(is_needed(sql, stage) ? JobState::queued : JobState::cancelled), stage});
    settle_bakes_of(sql, stage);
}

void Queue::cancel(const std::string& bake) {
    database_.write([&](Sql& sql) {
        const std::optional<JobState> state = state_of_bake(sql, bake);
        if (!state) refuse_unknown_bake(sql, bake);
        if (!is_live(*state))
            throw Refusal(Refused::conflict, std::string("the bake is ") + name_of(*state) +
                                                 "; only a queued or running one can be cancelled");
        sql.run("UPDATE bakes SET state = 'cancelled', finished = ? WHERE id = ?", {now(), bake});
        for (const std::string& stage : stages_of(sql, bake)) drop_unneeded(sql, stage);
    });
}

/// A stored stage lost a file: it and its bakes start again when the inputs are stored, else fail.
void Queue::requeue_stage(Sql& sql, const std::string& stage) {
    const bool inputs_stored =
        sql.rows(
               "SELECT 1 FROM stage_inputs i WHERE stage = ? AND NOT EXISTS(SELECT 1 FROM blobs b "
               "WHERE b.sha256 = i.sha256)",
               {stage})
            .empty();
    sql.run("DELETE FROM stage_files WHERE stage = ?", {stage});
    const StageError error{
        ErrorKind::bad_input, "a stored result was lost, and so was an input of it; send the input again", {}};
    sql.run(
        "UPDATE stages SET state = ?, manifest = NULL, attempts = 0, crashes = 0, deaths = NULL, ends = 0, error = ? "
        "WHERE key = ?",
        {name_of(inputs_stored ? JobState::queued : JobState::failed),
         inputs_stored ? SqlValue(nullptr) : SqlValue(error_json(error)), stage});
    for (const std::string& bake : live_or_done_bakes_of(sql, stage)) {
        sql.run("UPDATE bakes SET state = 'queued', finished = NULL WHERE id = ?", {bake});
        settle_bake(sql, bake);
    }
}

void Queue::blob_lost(Sql& sql, const std::string& digest) {
    sql.run("UPDATE inputs SET thumbnail = NULL WHERE thumbnail = ?", {digest});
    sql.run("DELETE FROM inputs WHERE sha256 = ?", {digest});
    for (const SqlRow& row : sql.rows("SELECT DISTINCT stage FROM stage_files WHERE sha256 = ?", {digest}))
        requeue_stage(sql, row.text(0));
    wake();  // claim() waits for the writer's lock, and so for the commit
}

}  // namespace hairbake
