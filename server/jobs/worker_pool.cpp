#include "server/jobs/worker_pool.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>

#include "core/base/assert.h"
#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/base/json_nesting.h"
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
#include "server/store/room.h"

namespace hairbake {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using End = Outcome::End;
constexpr std::chrono::seconds retry_after{1};
constexpr std::size_t longest_manifest = 512 << 10;  // bytes; the longest ones have some 50 kB

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

std::vector<std::string> digests_of(const ClaimedStage& stage) {
    std::vector<std::string> digests;
    for (const auto& [field, digest] : files_of(Json::parse(stage.request))) digests.push_back(digest);
    return digests;
}

/// A missing file in a folder that is there has not its digest.
/// Throws Error with the system's error number when the file cannot be read.
bool has_its_digest(const fs::path& file, const std::string& digest) try {
    return digest_of_file(file) == digest;
} catch (const Error& error) {
    if (error.system_error() == ENOENT && fs::is_directory(file.parent_path())) return false;
    throw;
}

/// Clients see the message; they need not know where the store is.
void hide(std::string& message, const std::string& folder) {
    for (std::size_t at = 0; (at = message.find(folder)) != std::string::npos;)
        message.replace(at, folder.size(), "the store");
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
            spdlog::error("a thread of the worker pool: {}", error.what());
            queue_.pause("", error.what());
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
        hide(outcome.message, store_.incoming_folder().parent_path().string());
    }
    if (outcome.end == End::died || (outcome.end == End::failed && outcome.kind == ErrorKind::internal))
        outcome = explain_death(std::move(outcome), runner_, store_.incoming_folder(),
                                [&] { return queue_.stopping() || *stage.cancel ? Wish::stop : Wish::go_on; });
    spdlog::info("stage {} {} attempt {}: {}", stage.kind, stage.key.substr(0, 12), stage.attempt, log_text(outcome));
    if (outcome.end == End::trouble) queue_.pause(stage.key, outcome.message);
    for (;;) try {
            return record(stage, outcome);
        } catch (const std::exception& error) {
            spdlog::error("the end of stage {} cannot be recorded: {}", stage.key.substr(0, 12), error.what());
            queue_.pause("", error.what());
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
            return queue_.died(stage, outcome.message);
        case End::trouble:
            return queue_.given_back(stage);
        case End::cancelled:
            return queue_.released(stage);
        case End::done:
        case End::left:
            return;
    }
}

/// The task as server/worker/task.h describes it: the stage's request with the paths of the blobs.
/// Throws Error(bad_input) when an input is no longer stored.
std::string WorkerPool::task_for(const ClaimedStage& stage) {
    Json request = Json::parse(stage.request), names = Json::object();
    for (const auto& [field, digest] : files_of(request)) {
        const std::string name = request[field].get<std::string>();
        if (!store_.size_of(digest))
            throw Error(ErrorKind::bad_input, name + " is no longer stored; send it again", field);
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
    std::vector<std::string> suspects = digests_of(stage);
    if (outcome.end == End::trouble)
        std::erase_if(suspects, [&](const std::string& digest) { return fs::exists(store_.path_of(digest)); });
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

/// Forgets inputs that are missing or whose stored bytes do not have their digest.
/// Throws Error(bad_input) when there is one.
/// Throws Error with the system's error number when one cannot be read now.
void WorkerPool::remove_spoiled_inputs(const std::vector<std::string>& digests) {
    for (const std::string& digest : digests)
        if (!has_its_digest(store_.path_of(digest), digest)) {
            store_.lose(digest, [&](Sql& sql) { queue_.blob_lost(sql, digest); });  // and the facts read from it
            throw Error(ErrorKind::bad_input,
                        "the stored bytes of sha256:" + digest + " were spoiled; send them again");
        }
}

/// The text of the result's manifest.
/// Throws WrongResult when it is missing, no JSON, or of another stage key.
/// Throws Error with the system's error number when the work folder is gone or the file cannot be opened.
/// Throws Error(bad_input) when it is of another stage key because an input was spoiled.
std::string WorkerPool::checked_manifest(const ClaimedStage& stage, const fs::path& folder) {
    const fs::path file = folder / "manifest.json";
    std::ifstream stream(file, std::ios::binary);
    if (!stream && !(errno == ENOENT && fs::is_directory(folder.parent_path())))
        throw Error(ErrorKind::internal, file.string() + ": " + std::generic_category().message(errno), {}, errno);
    std::string text(longest_manifest + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > longest_manifest || nested_deeper_than(text, deepest_json))
        throw WrongResult("the worker's manifest is longer than " + std::to_string(longest_manifest) +
                          " bytes, or nested deeper than " + std::to_string(deepest_json) + " levels");
    const Json manifest = Json::parse(text, nullptr, false);
    if (!manifest.is_object()) throw WrongResult("the worker reported success, but its manifest is missing or no JSON");
    if (manifest.at("stages").at(stage.kind).at("key") != stage.core_key) {
        remove_spoiled_inputs(digests_of(stage));
        throw WrongResult("the worker made another key than the daemon");
    }
    return text;
}

/// Throws ResultTooLarge when the whole budget is less than the result.
void WorkerPool::check_fits(const std::vector<StageFile>& files, const fs::path& folder) {
    std::map<std::string, std::uint64_t> sizes;  // by digest: equal files are one blob
    for (const StageFile& file : files) sizes[file.sha256] = fs::file_size(folder / file.name);
    std::uint64_t bytes = 0;
    for (const auto& [digest, size] : sizes) bytes += size;
    if (bytes > room_.budget())
        throw ResultTooLarge("the result of " + std::to_string(bytes) +
                             " bytes is larger than the whole store may be: " + "budget_mb is " +
                             std::to_string(room_.budget() >> 20) + "; ask for a smaller result, or raise budget_mb");
}

/// Bytes by which the store grows with a result.
std::uint64_t WorkerPool::new_bytes(const std::vector<StageFile>& files, const fs::path& folder) {
    std::uint64_t bytes = 0;
    for (const StageFile& file : files)
        if (!store_.size_of(file.sha256)) bytes += fs::file_size(folder / file.name);
    return bytes;
}

/// A worker is not believed: key and digests are checked before its files become blobs.
/// Throws Refusal(full) when there is no room for the result now.
void WorkerPool::store_result(const ClaimedStage& stage, std::unique_ptr<WorkFolder> work) {
    const fs::path folder = work->path() / "result";
    const std::string manifest = checked_manifest(stage, folder);
    const Json described = Json::parse(manifest);
    std::vector<StageFile> files;
    for (const Json& entry : described.at("files")) {
        const std::string name = entry.at("name").get<std::string>(), digest = entry.at("sha256").get<std::string>();
        if (name.find('/') != std::string::npos || !has_its_digest(folder / name, digest))
            throw WrongResult("the worker's file " + name + " is not as its manifest describes it");
        files.push_back({name, digest, entry.at("bytes").get<std::uint64_t>()});
    }
    check_fits(files, folder);
    const auto held = database_.lock();  // no eviction may come between the blobs and the rows that refer to them
    room_.make_room(new_bytes(files, folder));
    for (const StageFile& file : files) store_.adopt(folder / file.name, file.sha256, Origin::made);
    work.reset();  // before anybody learns that the stage is done
    queue_.done(stage, files, manifest);
}

}  // namespace hairbake
