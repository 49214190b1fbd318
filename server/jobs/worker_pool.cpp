#include "server/jobs/worker_pool.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>

#include "core/base/assert.h"
#include "core/base/error.h"
#include "core/request/request_json.h"
#include "core/request/stages.h"
#include "server/jobs/queue.h"
#include "server/jobs/runner.h"
#include "server/jobs/stage_outcome.h"
#include "server/jobs/stage_plan.h"
#include "server/jobs/task_follower.h"
#include "server/jobs/work_folder.h"
#include "server/jobs/worker_trial.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/file_system.h"
#include "server/store/room.h"
#include "server/store/store_advice.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using End = Outcome::End;
constexpr std::chrono::seconds retry_after{1};

/// The request's fields that name files, with their digests.
std::vector<std::pair<std::string, std::string>> files_of(const Json& request) {
    std::vector<std::pair<std::string, std::string>> files;
    for (const FileField& field : file_fields())
        if (request.contains(field.name) && request[field.name].is_string())
            files.emplace_back(field.name, request[field.name].get<std::string>().substr(7));
    return files;
}

/// The phases of the stage's work. None for a stage that this version does not know.
std::vector<Phase> phases_of(const ClaimedStage& stage) {
    const Stage* const known = find_stage(stage.kind);
    if (!known) return {};
    BakeRequest request;
    merge_json(request, stage.request, "the stage's request");
    return planned_phases(std::span(&known, 1), request);
}

/// By the system's text, which the messages of workers and of the store have.
bool is_full_disk(const Outcome& outcome) {
    return outcome.message.find(std::generic_category().message(ENOSPC)) != std::string::npos;
}

std::string log_text(const Outcome& outcome) {
    switch (outcome.end) {
        case End::done:
            return "done";
        case End::cancelled:
            return "stopped";
        case End::left:
            return "left running";
        default:
            return outcome.message;
    }
}

}  // namespace

WorkerPool::WorkerPool(Queue& queue, Runner& runner, Database& database, BlobStore& store, Room& room,
                       const WorkerPoolSettings& settings)
    : queue_(queue), runner_(runner), database_(database), store_(store), room_(room), settings_(settings) {
    for (int i = 0; i < settings_.workers; ++i) threads_.emplace_back([this] { work(); });
}

WorkerPool::~WorkerPool() { HAIRBAKE_ASSERT(queue_.stopping()); }

void WorkerPool::work() {
    for (;;) try {
            const std::optional<ClaimedStage> stage = queue_.claim();
            if (!stage) return;
            run_to_the_end(*stage);
            remove_leftovers();
            room_.trim();
        } catch (const std::exception& error) {  // the database cannot be written
            const std::string reason = error_text(error);
            spdlog::error("a thread of the worker pool: {}", reason);
            queue_.pause("", reason);
        }
}

/// Runs the stage and records how it ended, retrying while the database cannot be written. A stage that a stop of the
/// daemon leaves `running` is found at the next start.
void WorkerPool::run_to_the_end(const ClaimedStage& stage) {
    Outcome outcome;
    try {
        outcome = run(stage);
    } catch (...) {
        outcome = outcome_of_exception();
        if (outcome.end != End::trouble)  // what the machine lacks is for the operator, who needs the path
            outcome.message = without_path(outcome.message, store_.incoming_folder().parent_path());
    }
    if (outcome.end == End::died || (outcome.end == End::failed && outcome.kind == ErrorKind::internal))
        outcome = explain_death(std::move(outcome), runner_, store_.incoming_folder(),
                                [&] { return queue_.stopping() || *stage.cancel ? Wish::stop : Wish::go_on; });
    if (outcome.end == End::died && outcome.from_outside)
        if (std::optional<std::string> trouble = queue_.trouble_in_death(stage, outcome.message)) {
            outcome.end = End::trouble;
            outcome.message = *std::move(trouble);
        }
    spdlog::info("stage {} {} attempt {}: {}", stage.kind, stage.key.substr(0, 12), stage.attempt, log_text(outcome));
    if (outcome.end == End::trouble) queue_.pause(stage.key, outcome.message);
    if (outcome.end != End::trouble) forget_result(stage);
    if (outcome.end == End::trouble && is_full_disk(outcome)) note_full_disk(stage);
    for (;;) try {
            return record(stage, outcome);
        } catch (const std::exception& error) {
            const std::string reason = error_text(error);
            spdlog::error("the end of stage {} cannot be recorded: {}", stage.key.substr(0, 12), reason);
            queue_.pause("", reason);
            if (queue_.stopping()) return;
            std::this_thread::sleep_for(retry_after);
        }
}

/// A stage that is done was recorded with its files.
void WorkerPool::record(const ClaimedStage& stage, const Outcome& outcome) {
    switch (outcome.end) {
        case End::failed:
            return queue_.failed(stage, {outcome.kind, outcome.message, outcome.field});
        case End::died:
            return queue_.died(stage, outcome.message, outcome.from_outside);
        case End::trouble:
            return queue_.given_back(stage);
        case End::cancelled:
            return queue_.released(stage);
        case End::done:
        case End::left:
            return;
    }
}

std::vector<std::string> WorkerPool::input_digests(const ClaimedStage& stage) {
    std::vector<std::string> digests;
    for (const auto& [field, digest] : files_of(Json::parse(stage.request))) digests.push_back(digest);
    return digests;
}

/// The task as server/worker/task.h describes it: the stage's request with the paths of the blobs.
/// Throws Error(bad_input) when an input is no longer stored.
std::string WorkerPool::task_for(const ClaimedStage& stage) {
    Json request = Json::parse(stage.request), names = Json::object();
    for (const auto& [field, digest] : files_of(request)) {
        const std::string name = request[field].get<std::string>();
        if (!store_.size_of(digest))
            throw Error(ErrorKind::bad_input, name + " is no longer stored; send it again", field);
        const PathKind kind = kind_of_path(store_.path_of(digest));
        if (kind == PathKind::folder || kind == PathKind::other) remove_spoiled_inputs({digest});
        store_.touch(digest);
        const std::string path = store_.path_of(digest).string();
        request[field] = path;
        names[path] = name;
    }
    return Json{{"task", "bake"},
                {"stages", {stage.kind}},
                {"request", request},
                {"threads", settings_.threads},
                {"names", names}}
        .dump();
}

/// Starts a worker; returns its handle, which is stored when another daemon can use it.
std::string WorkerPool::start(const ClaimedStage& stage, const WorkFolder& folder) {
    const std::string handle = runner_.start(folder.path());
    if (!runner_.survives_restart()) return handle;
    try {
        queue_.started({stage.key, handle, folder.path().filename().string()}, settings_.runner);
    } catch (...) {
        runner_.stop(handle);
        throw;
    }
    return handle;
}

/// Runs the stage's worker, or follows the one that an earlier daemon started.
Outcome WorkerPool::run_worker(const ClaimedStage& stage, WorkFolder& folder) {
    const std::string handle = stage.started ? stage.started->handle : start(stage, folder);
    const auto wish = [&] {
        if (queue_.stopping() && runner_.survives_restart()) return Wish::leave;
        return *stage.cancel ? Wish::stop : Wish::go_on;
    };
    const std::vector<Phase> phases = phases_of(stage);
    Outcome outcome = follow_task(runner_, handle, folder, wish, [&](std::string_view phase, double fraction) {
        queue_.progress(stage.key, std::string(phase), fraction_of_whole(phases, phase, fraction));
    });
    if (outcome.end == End::left) folder.leave();
    return outcome;
}

/// Runs the stage's worker and stores its result.
/// Throws what outcome_of_exception() takes.
Outcome WorkerPool::run(const ClaimedStage& stage) {
    struct Leftover {  // ends after `folder`
        WorkerPool& pool;
        fs::path path{};
        ~Leftover() { pool.note_leftover(path); }
    } leftover{*this};
    if (!stage.started) check_known_result(stage);
    auto folder = stage.started ? std::make_unique<WorkFolder>(store_.incoming_folder() / stage.started->folder)
                                : std::make_unique<WorkFolder>(store_.incoming_folder(), task_for(stage));
    leftover.path = folder->path();
    Outcome outcome = run_worker(stage, *folder);
    if (outcome.end == End::done) {
        store_result(stage, std::move(folder));
        return outcome;
    }
    if (outcome.end == End::left) {
        leftover.path.clear();
        return outcome;
    }
    folder.reset();  // first: on a full disk the database may need its space
    std::vector<std::string> suspects = input_digests(stage);
    if (outcome.end == End::trouble) {
        outcome.message += store_.advice_for_closed(suspects);
        std::erase_if(suspects, [&](const std::string& digest) {
            return kind_of_path(store_.path_of(digest)) != PathKind::nothing;  // also what cannot be looked at
        });
    }
    const bool of_input = outcome.end == End::failed && outcome.kind == ErrorKind::bad_input;
    if (of_input || outcome.end == End::trouble) remove_spoiled_inputs(suspects);
    return outcome;
}

/// Notes a work folder that is still there.
void WorkerPool::note_leftover(const fs::path& folder) {
    std::error_code error;
    if (folder.empty() || !fs::exists(folder, error)) return;
    const std::lock_guard lock(mutex_);
    leftovers_.push_back(folder);
}

/// Tries again to remove work folders that were left when the store could not be written.
void WorkerPool::remove_leftovers() {
    const std::lock_guard lock(mutex_);
    std::erase_if(leftovers_, [](const fs::path& folder) {
        std::error_code error;
        fs::remove_all(folder, error);
        return !error;
    });
}

}  // namespace hairbake
