#include "server/jobs/worker_pool.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>

#include "core/base/assert.h"
#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/request/request_json.h"
#include "core/request/stages.h"
#include "server/jobs/queue.h"
#include "server/jobs/runner.h"
#include "server/jobs/stage_plan.h"
#include "server/jobs/task_follower.h"
#include "server/jobs/work_folder.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/refusal.h"
#include "server/store/room.h"

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
            room_.trim();
        } catch (const std::exception& error) {  // the database cannot be written
            spdlog::error("a thread of the worker pool: {}", error.what());
            std::this_thread::sleep_for(retry_after);
            if (queue_.stopping()) return;
        }
}

/// Runs the stage and records how it ended, retrying while the database cannot be written. A stage that a stop of the
/// daemon leaves `running` is found at the next start.
void WorkerPool::run_to_the_end(const ClaimedStage& stage) {
    StageError failure;
    bool run_again = false;
    try {
        return run(stage);
    } catch (const Refusal& refusal) {  // memory or descriptors are short
        failure = {ErrorKind::out_of_resources, refusal.what(), ""};
        run_again = refusal.why() == Refused::busy;
    } catch (const Error& error) {
        const bool has_own_kind = error.kind() == ErrorKind::out_of_resources || error.kind() == ErrorKind::bad_input;
        failure = {has_own_kind ? error.kind() : ErrorKind::internal, error.what(), error.field()};
    } catch (const std::exception& error) {
        failure = {ErrorKind::internal, error.what(), ""};
    }
    while (!queue_.stopping()) try {
            if (!run_again) return queue_.failed(stage, failure);
            spdlog::warn("stage {} starts again: {}", stage.key.substr(0, 12), failure.message);
            std::this_thread::sleep_for(retry_after);
            return queue_.released(stage);
        } catch (const std::exception& error) {
            spdlog::error("the end of stage {} cannot be recorded: {}", stage.key.substr(0, 12), error.what());
            std::this_thread::sleep_for(retry_after);
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

void WorkerPool::run(const ClaimedStage& stage) {
    auto folder = stage.started ? std::make_unique<WorkFolder>(store_.incoming_folder() / stage.started->folder)
                                : std::make_unique<WorkFolder>(store_.incoming_folder(), task_for(stage));
    const Outcome outcome = run_worker(stage, *folder);
    spdlog::info("stage {} {} attempt {}: {}", stage.kind, stage.key.substr(0, 12), stage.attempt, log_text(outcome));
    if (outcome.end == End::done) return store_result(stage, std::move(folder));
    folder.reset();  // first: on a full disk the database may need its space
    if (outcome.end == End::failed)
        queue_.failed(stage, {outcome.kind, outcome.message, outcome.field});
    else if (outcome.end == End::died)
        queue_.died(stage, outcome.message);
    else if (outcome.end == End::cancelled)
        queue_.released(stage);
}

/// Forgets inputs whose stored bytes do not have their digest.
/// Throws Error(bad_input) when there is one.
void WorkerPool::remove_spoiled_inputs(const std::vector<std::string>& digests) {
    for (const std::string& digest : digests)
        if (digest_of_file(store_.path_of(digest)) != digest) {
            store_.lose(digest, [&](Sql& sql) { queue_.blob_lost(sql, digest); });  // and the facts read from it
            throw Error(ErrorKind::bad_input,
                        "the stored bytes of sha256:" + digest + " were spoiled; send them again");
        }
}

/// The text of the result's manifest.
/// Throws Error when it is missing, no JSON, or of another stage key: then the worker read other bytes than the request
/// names, or is of another version.
std::string WorkerPool::checked_manifest(const ClaimedStage& stage, const fs::path& folder) {
    std::ifstream stream(folder / "manifest.json", std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const Json manifest = Json::parse(text, nullptr, false);
    if (!manifest.is_object())
        throw Error(ErrorKind::internal, "the worker reported success, but its manifest is missing or no JSON");
    if (manifest.at("stages").at(stage.kind).at("key") != stage.core_key) {
        std::vector<std::string> digests;
        for (const auto& [field, digest] : files_of(Json::parse(stage.request))) digests.push_back(digest);
        remove_spoiled_inputs(digests);
        throw Error(ErrorKind::internal, "the worker made another key than the daemon: they are not of one version");
    }
    return text;
}

/// Bytes by which the store grows with a result.
std::uint64_t WorkerPool::new_bytes(const std::vector<StageFile>& files, const fs::path& folder) {
    std::uint64_t bytes = 0;
    for (const StageFile& file : files)
        if (!store_.size_of(file.sha256)) bytes += fs::file_size(folder / file.name);
    return bytes;
}

/// A worker is not believed: key and digests are checked before its files become blobs.
void WorkerPool::store_result(const ClaimedStage& stage, std::unique_ptr<WorkFolder> work) {
    const fs::path folder = work->path() / "result";
    const std::string manifest = checked_manifest(stage, folder);
    const Json described = Json::parse(manifest);
    std::vector<StageFile> files;
    for (const Json& entry : described.at("files")) {
        const std::string name = entry.at("name").get<std::string>(), digest = entry.at("sha256").get<std::string>();
        if (name.find('/') != std::string::npos || digest_of_file(folder / name) != digest)
            throw Error(ErrorKind::internal, "the worker's file " + name + " is not as its manifest describes it");
        files.push_back({name, digest, entry.at("bytes").get<std::uint64_t>()});
    }
    const auto held = database_.lock();  // no eviction may come between the blobs and the rows that refer to them
    room_.make_room(new_bytes(files, folder));
    for (const StageFile& file : files) store_.adopt(folder / file.name, file.sha256, Origin::made);
    work.reset();  // before anybody learns that the stage is done
    queue_.done(stage, files, manifest);
}

}  // namespace hairbake
