#include "server/jobs/queue.h"

#include <algorithm>

#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/refusal.h"

namespace hairbake {

Queue::Queue(Database& database, BlobStore& store, const DeathRules& rules)
    : database_(database),
      store_(store),
      rules_(rules),
      watch_(std::chrono::duration_cast<DeathWatch::Duration>(std::chrono::duration<double>(longest_wait(rules)))) {}

// ---- boot ----------------------------------------------------------------------------------------------------------

std::vector<StartedTask> Queue::started_tasks(const std::string& runner) {
    std::vector<StartedTask> tasks;
    database_.read([&](Sql& sql) {
        for (const SqlRow& row :
             sql.rows("SELECT key, handle, work_folder FROM stages WHERE state = 'running' AND runner = ?", {runner}))
            tasks.push_back({row.text(0), row.text(1), row.text(2)});
    });
    return tasks;
}

Queue::Recovered Queue::recover(const std::vector<StartedTask>& surviving) {
    Recovered recovered;
    const auto survives = [&](const std::string& stage) {
        return std::any_of(surviving.begin(), surviving.end(),
                           [&](const StartedTask& task) { return task.stage == stage; });
    };
    database_.write([&](Sql& sql) {
        for (const SqlRow& row : sql.rows("SELECT key, ends FROM stages WHERE state = 'running'")) {
            if (survives(row.text(0))) continue;
            release_stage(sql, row.text(0));
            sql.run("UPDATE stages SET ends = ends + 1 WHERE key = ?", {row.text(0)});
            hold_after_ends(row.text(0), static_cast<int>(row.integer(1)) + 1);
        }
        hold_after_deaths(sql);
        recovered.lost = requeue_incomplete(sql);
        recovered.planned_again = plan_queued_again(sql);
    });
    database_.read([&](Sql& sql) {
        for (const StartedTask& task : surviving) resume(sql, task);
    });
    return recovered;
}

void Queue::resume(Sql& sql, const StartedTask& task) {
    const SqlRow row =
        sql.rows("SELECT kind, core_key, request, attempts FROM stages WHERE key = ?", {task.stage}).at(0);
    ClaimedStage claimed{task.stage,
                         row.text(0),
                         row.text(1),
                         row.text(2),
                         static_cast<int>(row.integer(3)),
                         std::make_shared<std::atomic<bool>>(!is_needed(sql, task.stage)),
                         task};
    const std::lock_guard lock(mutex_);
    running_[claimed.key] = {claimed.cancel, {}};
    resumed_.push_back(std::move(claimed));
}

/// Looks for missing blobs in the whole database: an earlier start may have died after it had forgotten some.
std::size_t Queue::requeue_incomplete(Sql& sql) {
    const std::string not_stored = "NOT EXISTS(SELECT 1 FROM blobs b WHERE b.sha256 = ";
    sql.run("UPDATE inputs SET thumbnail = NULL WHERE thumbnail IS NOT NULL AND " + not_stored + "thumbnail)");
    sql.run("DELETE FROM inputs WHERE " + not_stored + "inputs.sha256)");
    const auto stages = sql.rows("SELECT DISTINCT stage FROM stage_files f WHERE " + not_stored + "f.sha256)");
    for (const SqlRow& row : stages) requeue_stage(sql, row.text(0));
    return stages.size();
}

// ---- taking requests -----------------------------------------------------------------------------------------------

/// A stage was last used when its most recently used file was (store/eviction.cpp), so touching one is enough.
void Queue::touch_stage(Sql& sql, const std::string& stage) {
    for (const SqlRow& row : sql.rows("SELECT sha256 FROM stage_files WHERE stage = ? LIMIT 1", {stage}))
        store_.touch(row.text(0));
}

void Queue::add_stage(Sql& sql, const StagePlan& stage, int priority) {
    const std::optional<JobState> state = state_of_stage(sql, stage.key);
    if (!state) {
        sql.run(
            "INSERT INTO stages(key, kind, core_key, state, request, priority, attempts, crashes, created) "
            "VALUES(?, ?, ?, 'queued', ?, ?, 0, 0, ?)",
            {stage.key, stage.kind, stage.core_key, stage.request, std::int64_t(priority), now()});
        for (const std::string& digest : stage.inputs)
            sql.run("INSERT INTO stage_inputs VALUES(?, ?)", {stage.key, digest});
    } else if (is_live(*state)) {
        sql.run("UPDATE stages SET priority = max(priority, ?) WHERE key = ?", {std::int64_t(priority), stage.key});
    } else if (*state == JobState::done) {
        touch_stage(sql, stage.key);
    } else {
        sql.run(
            "UPDATE stages SET state = 'queued', priority = ?, attempts = 0, crashes = 0, deaths = NULL, ends = 0, "
            "error = NULL WHERE key = ?",
            {std::int64_t(priority), stage.key});
        const std::lock_guard lock(mutex_);
        pause_.forget(stage.key);
    }
}

Submitted Queue::add_bake(Sql& sql, const BakePlan& plan) {
    const std::optional<JobState> state = state_of_bake(sql, plan.id);
    if (state == JobState::done) {
        note_names(sql, plan);
        return {plan.id, *state, note_done(sql, plan.id, plan.names)};
    }
    for (const StagePlan& stage : plan.stages) add_stage(sql, stage, plan.priority);
    if (!state)
        insert_bake(sql, plan);
    else if (is_live(*state))
        sql.run("UPDATE bakes SET priority = max(priority, ?) WHERE id = ?", {std::int64_t(plan.priority), plan.id});
    else
        sql.run(
            "UPDATE bakes SET state = 'queued', priority = ?, attempts = attempts + 1, error = NULL, finished = NULL "
            "WHERE id = ?",
            {std::int64_t(plan.priority), plan.id});
    note_names(sql, plan);
    settle_bake(sql, plan.id);
    return {plan.id, state_of_bake(sql, plan.id).value(), false};
}

bool Queue::note_done(Sql& sql, const std::string& bake, const std::string& names) {
    const auto rows = sql.rows(
        "SELECT 1 FROM bakes WHERE id = ? AND state = 'done' AND json_patch(names, ?) = json(names)", {bake, names});
    if (rows.empty()) return false;
    for (const std::string& stage : stages_of(sql, bake)) touch_stage(sql, stage);
    return true;
}

std::vector<Submitted> Queue::submit(const std::vector<BakePlan>& plans) {
    std::vector<Submitted> answers;
    database_.write([&](Sql& sql) {
        for (const BakePlan& plan : plans) answers.push_back(add_bake(sql, plan));
    });
    wake();
    return answers;
}

void Queue::submit_batch(const std::string& id, const std::string& request, const EachPlan& each_plan) {
    database_.write([&](Sql& sql) {
        sql.run("INSERT INTO batches(id, request, created) VALUES(?, ?, ?)", {id, request, now()});
        each_plan(sql, [&](const BakePlan& plan) {
            add_bake(sql, plan);
            sql.run("INSERT OR IGNORE INTO batch_bakes SELECT ?, id, seq FROM bakes WHERE id = ?", {id, plan.id});
        });
    });
    wake();
}

// ---- claims --------------------------------------------------------------------------------------------------------

void Queue::wake() {
    {
        const std::lock_guard lock(mutex_);
        ++changes_;
    }
    changed_.notify_all();
}

void Queue::started(const StartedTask& task, const std::string& runner) {
    database_.write([&](Sql& sql) {
        sql.run("UPDATE stages SET runner = ?, handle = ?, work_folder = ? WHERE key = ?",
                {runner, task.handle, task.folder, task.stage});
    });
}

void Queue::progress(const std::string& key, const std::string& phase, double fraction) {
    const std::lock_guard lock(mutex_);
    if (const auto running = running_.find(key); running != running_.end())
        running->second.progress = {phase, std::max(fraction, running->second.progress.fraction)};
}

std::optional<StageProgress> Queue::progress_of(const std::string& key) {
    const std::lock_guard lock(mutex_);
    const auto running = running_.find(key);
    return running == running_.end() ? std::nullopt : std::optional(running->second.progress);
}

void Queue::done(const ClaimedStage& stage, const std::vector<StageFile>& files, const std::string& manifest) {
    database_.write([&](Sql& sql) {
        sql.run("DELETE FROM stage_files WHERE stage = ?", {stage.key});
        for (const StageFile& file : files)
            sql.run("INSERT INTO stage_files VALUES(?, ?, ?, ?)",
                    {stage.key, file.name, file.sha256, static_cast<std::int64_t>(file.bytes)});
        sql.run("UPDATE stages SET state = 'done', manifest = ?, error = NULL, finished = ? WHERE key = ?",
                {manifest, now(), stage.key});
        settle_bakes_of(sql, stage.key);
    });
    end_well(stage);
}

void Queue::fail_stage(Sql& sql, const std::string& stage, const StageError& error) {
    sql.run("UPDATE stages SET state = 'failed', error = ?, finished = ? WHERE key = ?",
            {error_json(error), now(), stage});
    settle_bakes_of(sql, stage);
}

void Queue::failed(const ClaimedStage& stage, const StageError& error) {
    database_.write([&](Sql& sql) { fail_stage(sql, stage.key, error); });
    end_well(stage);
}

void Queue::released(const ClaimedStage& stage) {
    database_.write([&](Sql& sql) { release_stage(sql, stage.key); });
    {
        const std::lock_guard lock(mutex_);
        pause_.ended(stage.key, std::chrono::steady_clock::now());
        watch_.forget(stage.key);
    }
    finish_claim(stage);
}

void Queue::given_back(const ClaimedStage& stage) {
    database_.write([&](Sql& sql) {
        sql.run("UPDATE stages SET attempts = max(attempts - 1, 0) WHERE key = ?", {stage.key});
        release_stage(sql, stage.key);
    });
    finish_claim(stage);
}

void Queue::stop() {
    stopping_ = true;
    {
        const std::lock_guard lock(mutex_);
        for (auto& [key, running] : running_) *running.cancel = true;
    }
    wake();
}

}  // namespace hairbake
