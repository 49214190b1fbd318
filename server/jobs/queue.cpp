#include "server/jobs/queue.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

std::string error_json(const StageError& error) {
    return Json{{"kind", error.kind}, {"message", error.message}, {"field", error.field}}.dump(
        -1, ' ', false, Json::error_handler_t::replace);
}

SqlValue or_null(const std::optional<StagePlan>& stage) { return stage ? SqlValue(stage->key) : SqlValue(nullptr); }

SqlValue or_null(const std::string& text) { return text.empty() ? SqlValue(nullptr) : SqlValue(text); }

bool is_live(const std::string& state) { return state == "queued" || state == "running"; }

bool needed(Sql& sql, const std::string& stage) {
    return !sql.rows(
                   "SELECT 1 FROM bakes WHERE transmittance = ? AND state IN ('queued', 'running') UNION ALL "
                   "SELECT 1 FROM bakes WHERE irradiance = ? AND state IN ('queued', 'running') LIMIT 1",
                   {stage, stage})
                .empty();
}

/// Ids of the bakes of a stage whose state is one of `states` ("'queued', 'running'").
std::vector<std::string> bakes_of(Sql& sql, const std::string& stage, const std::string& states) {
    std::vector<std::string> ids;
    for (const SqlRow& row :
         sql.rows("SELECT id FROM bakes WHERE transmittance = ? AND state IN (" + states +
                      ") UNION SELECT id FROM bakes WHERE irradiance = ? AND state IN (" + states + ")",
                  {stage, stage}))
        ids.push_back(row.text(0));
    return ids;
}

/// A name that a bake is asked by now is noted beside those that it was asked by before; the bake itself tells the last
/// one of each field.
void note_names(Sql& sql, const BakePlan& plan) {
    sql.run("UPDATE bakes SET names = json_patch(names, ?) WHERE id = ?", {plan.names, plan.id});
    sql.run(
        "INSERT OR REPLACE INTO bake_names SELECT ?, key, json_extract(value, '$.path'), json_extract(value, "
        "'$.version'), (SELECT seq FROM bakes WHERE id = ?) FROM json_each(?)",
        {plan.id, plan.id, plan.names});
}

}  // namespace

Queue::Queue(Database& database, BlobStore& store, int max_crashes)
    : database_(database), store_(store), max_crashes_(max_crashes) {}

std::size_t Queue::recover() {
    std::size_t lost = 0;
    database_.write([&](Sql& sql) {
        std::vector<std::string> interrupted;
        for (const SqlRow& row : sql.rows("SELECT key FROM stages WHERE state = 'running'"))
            interrupted.push_back(row.text(0));
        for (const std::string& stage : interrupted) {
            sql.run("UPDATE stages SET state = ? WHERE key = ?", {needed(sql, stage) ? "queued" : "cancelled", stage});
            settle_bakes_of(sql, stage);
        }
        lost = requeue_incomplete(sql);
    });
    return lost;
}

/// It trusts no list of what was just found missing: an earlier start may have died after it had forgotten the blobs.
std::size_t Queue::requeue_incomplete(Sql& sql) {
    const std::string not_stored = "NOT EXISTS(SELECT 1 FROM blobs b WHERE b.sha256 = ";
    sql.run("UPDATE inputs SET thumbnail = NULL WHERE thumbnail IS NOT NULL AND " + not_stored + "thumbnail)");
    sql.run("DELETE FROM inputs WHERE " + not_stored + "inputs.sha256)");
    const auto stages = sql.rows("SELECT DISTINCT stage FROM stage_files f WHERE " + not_stored + "f.sha256)");
    for (const SqlRow& row : stages) requeue_stage(sql, row.text(0));
    return stages.size();
}

// ---- taking requests -----------------------------------------------------------------------------------------------

/// One file stands for its stage: see oldest_stage() of store/eviction.cpp.
void Queue::touch_stage(Sql& sql, const std::string& stage) {
    for (const SqlRow& row : sql.rows("SELECT sha256 FROM stage_files WHERE stage = ? LIMIT 1", {stage}))
        store_.touch(row.text(0));
}

void Queue::add_stage(Sql& sql, const StagePlan& stage, int priority) {
    const auto rows = sql.rows("SELECT state FROM stages WHERE key = ?", {stage.key});
    if (rows.empty()) {
        sql.run(
            "INSERT INTO stages(key, kind, core_key, state, request, priority, attempts, crashes, created) "
            "VALUES(?, ?, ?, 'queued', ?, ?, 0, 0, ?)",
            {stage.key, stage.kind, stage.core_key, stage.request, std::int64_t(priority), now()});
        for (const std::string& digest : stage.inputs)
            sql.run("INSERT INTO stage_inputs VALUES(?, ?)", {stage.key, digest});
        return;
    }
    const std::string state = rows[0].text(0);
    if (is_live(state))
        sql.run("UPDATE stages SET priority = max(priority, ?) WHERE key = ?", {std::int64_t(priority), stage.key});
    else if (state == "done")
        touch_stage(sql, stage.key);
    else
        sql.run(
            "UPDATE stages SET state = 'queued', priority = ?, attempts = 0, crashes = 0, error = NULL WHERE key = ?",
            {std::int64_t(priority), stage.key});
}

Submitted Queue::add_bake(Sql& sql, const BakePlan& plan) {
    const auto rows = sql.rows("SELECT state FROM bakes WHERE id = ?", {plan.id});
    const std::string state = rows.empty() ? "" : rows[0].text(0);
    if (state == "done") {
        note_names(sql, plan);
        return {plan.id, state, note_done(sql, plan.id, plan.names)};
    }
    for (const StagePlan* stage : plan.stages()) add_stage(sql, *stage, plan.priority);
    if (rows.empty())
        sql.run(
            "INSERT INTO bakes(id, state, request, names, hair, environment, priority, transmittance, irradiance, "
            "attempts, created) VALUES(?, 'queued', ?, ?, ?, ?, ?, ?, ?, 1, ?)",
            {plan.id, plan.request, plan.names, or_null(plan.hair), or_null(plan.environment),
             std::int64_t(plan.priority), or_null(plan.transmittance), or_null(plan.irradiance), now()});
    else if (is_live(state))
        sql.run("UPDATE bakes SET priority = max(priority, ?) WHERE id = ?", {std::int64_t(plan.priority), plan.id});
    else
        sql.run(
            "UPDATE bakes SET state = 'queued', priority = ?, attempts = attempts + 1, error = NULL, finished = NULL "
            "WHERE id = ?",
            {std::int64_t(plan.priority), plan.id});
    note_names(sql, plan);
    settle_bake(sql, plan.id);
    const std::string after = sql.rows("SELECT state FROM bakes WHERE id = ?", {plan.id}).at(0).text(0);
    return {plan.id, after, false};
}

bool Queue::note_done(Sql& sql, const std::string& bake, const std::string& names) {
    const auto rows = sql.rows(
        "SELECT transmittance, irradiance FROM bakes WHERE id = ? AND state = 'done' AND json_patch(names, ?) = "
        "json(names)",
        {bake, names});
    if (rows.empty()) return false;
    for (const std::size_t column : {0, 1})
        if (!rows[0].null(column)) touch_stage(sql, rows[0].text(column));
    return true;
}

std::vector<Submitted> Queue::submit(const std::vector<BakePlan>& plans, const std::string& batch,
                                     const std::string& batch_request) {
    std::vector<Submitted> answers;
    database_.write([&](Sql& sql) {
        for (const BakePlan& plan : plans) answers.push_back(add_bake(sql, plan));
        if (batch.empty()) return;
        sql.run("INSERT INTO batches(id, request, created) VALUES(?, ?, ?)", {batch, batch_request, now()});
        for (const BakePlan& plan : plans)
            sql.run("INSERT OR IGNORE INTO batch_bakes SELECT ?, id, seq FROM bakes WHERE id = ?", {batch, plan.id});
    });
    wake();
    return answers;
}

// ---- states --------------------------------------------------------------------------------------------------------

/// Makes a live bake's state what its stages' states say.
void Queue::settle_bake(Sql& sql, const std::string& bake) {
    const auto stages = sql.rows(
        "SELECT s.key, s.state, s.error FROM bakes b JOIN stages s ON s.key = b.transmittance OR s.key = b.irradiance "
        "WHERE b.id = ? AND b.state IN ('queued', 'running')",
        {bake});
    if (stages.empty()) return;
    const auto in = [](const char* state) { return [state](const SqlRow& row) { return row.text(1) == state; }; };
    const auto broken = std::find_if(stages.begin(), stages.end(), in("failed"));
    if (broken != stages.end()) {
        sql.run("UPDATE bakes SET state = 'failed', error = ?, finished = ? WHERE id = ?",
                {broken->text(2), now(), bake});
        for (const SqlRow& stage : stages) drop_unneeded(sql, stage.text(0));
    } else if (std::all_of(stages.begin(), stages.end(), in("done"))) {
        sql.run("UPDATE bakes SET state = 'done', finished = ? WHERE id = ?", {now(), bake});
    } else {
        const bool begun = std::any_of(stages.begin(), stages.end(), in("running")) ||
                           std::any_of(stages.begin(), stages.end(), in("done"));
        sql.run("UPDATE bakes SET state = ? WHERE id = ?", {begun ? "running" : "queued", bake});
    }
}

void Queue::settle_bakes_of(Sql& sql, const std::string& stage) {
    for (const std::string& bake : bakes_of(sql, stage, "'queued', 'running'")) settle_bake(sql, bake);
}

/// Cancels a live stage that no live bake needs.
void Queue::drop_unneeded(Sql& sql, const std::string& stage) {
    if (needed(sql, stage)) return;
    sql.run("UPDATE stages SET state = 'cancelled' WHERE key = ? AND state = 'queued'", {stage});
    const std::lock_guard lock(mutex_);
    if (const auto running = running_.find(stage); running != running_.end()) *running->second.cancel = true;
}

void Queue::cancel(const std::string& bake) {
    database_.write([&](Sql& sql) {
        const auto rows = sql.rows("SELECT state, transmittance, irradiance FROM bakes WHERE id = ?", {bake});
        if (rows.empty()) throw Refusal(Refused::not_found, "there is no bake " + bake.substr(0, 64));
        if (!is_live(rows[0].text(0)))
            throw Refusal(Refused::conflict,
                          "the bake is " + rows[0].text(0) + "; only a queued or running one can be cancelled");
        sql.run("UPDATE bakes SET state = 'cancelled', finished = ? WHERE id = ?", {now(), bake});
        for (const std::size_t column : {1, 2})
            if (!rows[0].null(column)) drop_unneeded(sql, rows[0].text(column));
    });
}

/// A stored stage lost a file: it and its bakes start again, as far as their inputs are there.
void Queue::requeue_stage(Sql& sql, const std::string& stage) {
    const bool inputs_stored =
        sql.rows(
               "SELECT 1 FROM stage_inputs i WHERE stage = ? AND NOT EXISTS(SELECT 1 FROM blobs b "
               "WHERE b.sha256 = i.sha256)",
               {stage})
            .empty();
    sql.run("DELETE FROM stage_files WHERE stage = ?", {stage});
    const StageError error{"bad_input", "a stored result was lost, and so was an input of it; send the input again",
                           ""};
    sql.run(
        "UPDATE stages SET state = ?, manifest = NULL, attempts = 0, crashes = 0, error = ? WHERE key = ?",
        {inputs_stored ? "queued" : "failed", inputs_stored ? SqlValue(nullptr) : SqlValue(error_json(error)), stage});
    for (const std::string& bake : bakes_of(sql, stage, "'queued', 'running', 'done'")) {
        sql.run("UPDATE bakes SET state = 'queued', finished = NULL WHERE id = ?", {bake});
        settle_bake(sql, bake);
    }
}

void Queue::blob_lost(Sql& sql, const std::string& digest) {
    sql.run("UPDATE inputs SET thumbnail = NULL WHERE thumbnail = ?", {digest});
    sql.run("DELETE FROM inputs WHERE sha256 = ?", {digest});
    for (const SqlRow& row : sql.rows("SELECT DISTINCT stage FROM stage_files WHERE sha256 = ?", {digest}))
        requeue_stage(sql, row.text(0));
    wake();  // who claims waits for the writer's lock, and so for the commit
}

// ---- slots ---------------------------------------------------------------------------------------------------------

void Queue::wake() {
    {
        const std::lock_guard lock(mutex_);
        ++changes_;
    }
    changed_.notify_all();
}

std::optional<ClaimedStage> Queue::claim() {
    while (!stopping_) {
        std::uint64_t seen = 0;
        {
            const std::lock_guard lock(mutex_);
            seen = changes_;
        }
        std::optional<ClaimedStage> claimed;
        auto held = database_.lock();  // until running_ knows the stage: a cancel must find it
        database_.write([&](Sql& sql) {
            const auto rows = sql.rows(
                "SELECT key, kind, core_key, request, attempts FROM stages WHERE state = 'queued' "
                "ORDER BY priority DESC, seq LIMIT 1");
            if (rows.empty()) return;
            claimed = {rows[0].text(0),
                       rows[0].text(1),
                       rows[0].text(2),
                       rows[0].text(3),
                       static_cast<int>(rows[0].integer(4)) + 1,
                       std::make_shared<std::atomic<bool>>(false)};
            sql.run("UPDATE stages SET state = 'running', attempts = attempts + 1, started = ? WHERE key = ?",
                    {now(), claimed->key});
            settle_bakes_of(sql, claimed->key);
        });
        std::unique_lock lock(mutex_);
        if (claimed) {
            running_[claimed->key] = {claimed->cancel, {}};
            if (stopping_) *claimed->cancel = true;  // stop() has walked the running ones already
            return claimed;
        }
        held.unlock();
        changed_.wait(lock, [&] { return stopping_ || changes_ != seen; });
    }
    return std::nullopt;
}

void Queue::progress(const std::string& key, const std::string& phase, double fraction) {
    const std::lock_guard lock(mutex_);
    if (const auto running = running_.find(key); running != running_.end())
        running->second.progress = {phase, fraction};
}

std::optional<StageProgress> Queue::progress_of(const std::string& key) {
    const std::lock_guard lock(mutex_);
    const auto running = running_.find(key);
    return running == running_.end() ? std::nullopt : std::optional(running->second.progress);
}

void Queue::finish_claim(const ClaimedStage& stage) {
    {
        const std::lock_guard lock(mutex_);
        running_.erase(stage.key);
    }
    wake();
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
    finish_claim(stage);
}

void Queue::failed(const ClaimedStage& stage, const StageError& error) {
    database_.write([&](Sql& sql) {
        sql.run("UPDATE stages SET state = 'failed', error = ?, finished = ? WHERE key = ?",
                {error_json(error), now(), stage.key});
        settle_bakes_of(sql, stage.key);
    });
    finish_claim(stage);
}

void Queue::died(const ClaimedStage& stage, const std::string& how) {
    bool again = true;
    database_.write([&](Sql& sql) {
        sql.run("UPDATE stages SET crashes = crashes + 1 WHERE key = ?", {stage.key});
        const auto crashes = sql.rows("SELECT crashes FROM stages WHERE key = ?", {stage.key}).at(0).integer(0);
        again = crashes <= max_crashes_;
    });
    if (again)
        released(stage);
    else
        failed(stage, {"internal", how + " (it was started " + std::to_string(max_crashes_ + 1) + " times)", ""});
}

void Queue::released(const ClaimedStage& stage) {
    database_.write([&](Sql& sql) {
        sql.run("UPDATE stages SET state = ? WHERE key = ?",
                {needed(sql, stage.key) ? "queued" : "cancelled", stage.key});
        settle_bakes_of(sql, stage.key);
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
