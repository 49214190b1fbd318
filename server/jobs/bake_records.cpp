#include "server/jobs/bake_records.h"

#include <nlohmann/json.hpp>

#include "core/base/error_kind_names.h"
#include "core/base/short_text.h"
#include "server/jobs/stage_plan.h"
#include "server/jobs/time_text.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

SqlValue or_null(const std::string& text) { return text.empty() ? SqlValue(nullptr) : SqlValue(text); }

std::vector<std::string> first_column(const std::vector<SqlRow>& rows) {
    std::vector<std::string> texts;
    texts.reserve(rows.size());
    for (const SqlRow& row : rows) texts.push_back(row.text(0));
    return texts;
}

std::optional<JobState> first_state(const std::vector<SqlRow>& rows) {
    return rows.empty() ? std::nullopt : job_state(rows[0].text(0));
}

}  // namespace

std::string error_json(const StageError& error) {
    return Json{{"kind", name_of(error.kind)}, {"message", error.message}, {"field", error.field}}.dump(
        -1, ' ', false, Json::error_handler_t::replace);
}

std::optional<JobState> state_of_stage(Sql& sql, const std::string& key) {
    return first_state(sql.rows("SELECT state FROM stages WHERE key = ?", {key}));
}

std::optional<JobState> state_of_bake(Sql& sql, const std::string& id) {
    return first_state(sql.rows("SELECT state FROM bakes WHERE id = ?", {id}));
}

std::vector<std::string> stages_of(Sql& sql, const std::string& bake) {
    return first_column(sql.rows(
        "SELECT m.stage FROM bakes b JOIN bake_stages m ON m.bake = b.seq WHERE b.id = ? ORDER BY m.seq", {bake}));
}

std::vector<std::string> live_bakes_of(Sql& sql, const std::string& stage) {
    return first_column(
        sql.rows("SELECT b.id FROM bake_stages m CROSS JOIN bakes b ON b.seq = m.bake "
                 "WHERE m.stage = ? AND b.state IN ('queued', 'running')",
                 {stage}));
}

std::vector<std::string> live_or_done_bakes_of(Sql& sql, const std::string& stage) {
    return first_column(
        sql.rows("SELECT b.id FROM bake_stages m CROSS JOIN bakes b ON b.seq = m.bake "
                 "WHERE m.stage = ? AND b.state IN ('queued', 'running', 'done')",
                 {stage}));
}

bool is_needed(Sql& sql, const std::string& stage) {
    return !sql.rows(
                   "SELECT 1 FROM bake_stages m CROSS JOIN bakes b ON b.seq = m.bake "
                   "WHERE m.stage = ? AND b.state IN ('queued', 'running') LIMIT 1",
                   {stage})
                .empty();
}

UnknownBake describe_unknown_bake(Sql& sql, const std::string& id) {
    const auto rows = sql.rows("SELECT state, time FROM forgotten_bakes WHERE id = ?", {id});
    if (rows.empty()) return {false, "there is no bake " + shortened(id, 64)};
    const std::string when = " was removed at " + time_text(rows[0].number(1));
    if (rows[0].text(0) == name_of(JobState::done))
        return {true, "the result of bake " + id + when +
                          " to make room in the store: results that were not used for the longest time go first. The "
                          "same request sent again bakes it anew ([store] budget_mb says how much the store keeps)"};
    return {true, "bake " + id + " ended as " + rows[0].text(0) + ", and its record" + when +
                      ". The same request sent again bakes it anew"};
}

void refuse_unknown_bake(Sql& sql, const std::string& id) {
    const UnknownBake unknown = describe_unknown_bake(sql, id);
    throw Refusal(unknown.was_there ? Refused::gone : Refused::not_found, unknown.words);
}

void insert_bake(Sql& sql, const BakePlan& plan) {
    sql.run("DELETE FROM forgotten_bakes WHERE id = ?", {plan.id});
    sql.run(
        "INSERT INTO bakes(id, state, request, names, hair, environment, priority, attempts, created) "
        "VALUES(?, 'queued', ?, ?, ?, ?, ?, 1, ?)",
        {plan.id, plan.request, plan.names, or_null(plan.hair), or_null(plan.environment), std::int64_t(plan.priority),
         now()});
    for (const StagePlan& stage : plan.stages)
        sql.run("INSERT INTO bake_stages(bake, kind, stage) SELECT seq, ?, ? FROM bakes WHERE id = ?",
                {stage.kind, stage.key, plan.id});
}

void note_names(Sql& sql, const BakePlan& plan) {
    sql.run("UPDATE bakes SET names = json_patch(names, ?) WHERE id = ?", {plan.names, plan.id});
    sql.run(
        "INSERT OR REPLACE INTO bake_names SELECT ?, key, json_extract(value, '$.path'), json_extract(value, "
        "'$.version'), (SELECT seq FROM bakes WHERE id = ?) FROM json_each(?)",
        {plan.id, plan.id, plan.names});
}

}  // namespace hairbake
