// The rows of bakes and stages in the database. All functions take part in the caller's transaction.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "server/jobs/job_state.h"

namespace hairbake {

class Sql;
struct BakePlan;

/// Why a stage or a bake failed.
struct StageError {
    ErrorKind kind = ErrorKind::internal;
    std::string message, field;
};

/// As the column `error` has it.
std::string error_json(const StageError& error);

/// The state of a stage or a bake. Nothing when there is no such row.
std::optional<JobState> state_of_stage(Sql& sql, const std::string& key);
std::optional<JobState> state_of_bake(Sql& sql, const std::string& id);

/// Keys of a bake's stages, in the order of its plan.
std::vector<std::string> stages_of(Sql& sql, const std::string& bake);

/// Ids of the bakes that have the stage and are live, or done as well.
std::vector<std::string> live_bakes_of(Sql& sql, const std::string& stage);
std::vector<std::string> live_or_done_bakes_of(Sql& sql, const std::string& stage);

/// Whether a live bake has the stage.
bool is_needed(Sql& sql, const std::string& stage);

/// Why there is no bake `id`: its result was removed to make room, its record was removed, or there never was one.
struct UnknownBake {
    bool was_there = false;
    std::string words;
};
UnknownBake describe_unknown_bake(Sql& sql, const std::string& id);

/// Throws Refusal(gone) for a bake that was there.
/// Throws Refusal(not_found) for another one.
[[noreturn]] void refuse_unknown_bake(Sql& sql, const std::string& id);

/// Inserts the bake, queued, with its stages, whose rows exist.
void insert_bake(Sql& sql, const BakePlan& plan);

/// Notes the names that a bake was asked by, beside those of earlier requests. The bake's own row keeps the latest name
/// of each field.
void note_names(Sql& sql, const BakePlan& plan);

}  // namespace hairbake
