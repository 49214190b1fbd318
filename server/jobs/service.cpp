#include "server/jobs/service.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>

#include "core/base/error.h"
#include "server/jobs/bake_request.h"
#include "server/jobs/input_removal.h"
#include "server/jobs/maintenance.h"
#include "server/jobs/queue.h"
#include "server/jobs/runner_kinds.h"
#include "server/jobs/scrub.h"
#include "server/jobs/sent_blobs.h"
#include "server/jobs/worker_pool.h"
#include "server/store/database.h"
#include "server/store/disk_reserve.h"
#include "server/store/file_system.h"
#include "server/store/room.h"
#include "server/store/store_folder.h"
#include "server/store/store_identity.h"

namespace hairbake {
namespace {

RunnerSettings runner_settings(const Settings& settings) {
    return {settings.worker, settings.memory_bytes, settings.cpu_seconds, settings.wall_seconds};
}

}  // namespace

/// Says what was lost, and which inputs people must send again: nobody can ask the database for them afterwards.
void log_lost(const LostBlobs& lost) {
    if (lost.results > 0) spdlog::warn("{} stored results are missing or spoiled", lost.results);
    if (lost.inputs.empty()) return;
    spdlog::error("{} inputs are missing or spoiled. They are forgotten and must be sent again:", lost.inputs.size());
    for (const std::string& input : lost.inputs) spdlog::error("send {} again", input);
}

/// In the order in which they start; they end in the opposite order.
struct Service::Parts {
    Parts(const Settings& given, std::unique_ptr<Runner> with)
        : settings(given),
          folder(settings.store, settings.store_id),
          database(folder.database(), folder.hooks()),
          identity(folder.path(), database, settings.store_id),
          store(settings.store, database),
          reserve(settings.store, database),
          room(database, store, reserve, settings.store, {settings.budget_bytes, settings.keep_free_bytes}),
          runner(std::move(with)),
          inspector(make_runner(local_runner_name, runner_settings(settings))),
          queue(database, store, {settings.max_crashes, settings.crash_wait_s}),
          bakes(database, queue),
          batches(database, queue),
          catalog(database, store, *inspector),
          names(database),
          uploads(database, store, room, reserve, settings.store / "uploads",
                  {settings.upload_lifetime_s, settings.blob_bytes, settings.budget_bytes, settings.open_uploads}) {}

    /// The workers of an earlier daemon that still run, as far as their work folders are there.
    std::vector<StartedTask> surviving_tasks() {
        if (!runner->survives_restart()) return {};
        std::vector<StartedTask> tasks = queue.started_tasks(settings.runner);
        std::erase_if(tasks, [&](const StartedTask& task) {
            return kind_of_path(store.incoming_folder() / task.folder) == PathKind::nothing;
        });
        return tasks;
    }

    /// On a full disk the service starts all the same, to serve what is stored.
    void begin_generation() try { identity.advance(); } catch (const Error& error) {
        if (error.kind() != ErrorKind::out_of_resources) throw;
        spdlog::warn("the store's generation cannot be recorded: {}", error.what());
    }

    /// During an upgrade the worker program may be away. The service starts all the same, to serve what is stored.
    void check_worker() try { runner->check_ready(); } catch (const Error& error) {
        spdlog::warn("{}; the queue is paused and tries again by itself", error.what());
        queue.pause({}, error.what());
    }

    void boot() {
        const std::vector<StartedTask> surviving = surviving_tasks();
        std::set<std::string> spared;
        for (const StartedTask& task : surviving) spared.insert(task.folder);
        log_lost(store.recover(spared, identity.accepted()));
        uploads.recover();
        store.log_lost_found();
        const Queue::Recovered recovered = queue.recover(surviving);
        if (recovered.lost) spdlog::warn("{} stages lost files; they are baked again", recovered.lost);
        if (recovered.planned_again)
            spdlog::info("{} queued stages of another version of hairbake were planned again", recovered.planned_again);
        begin_generation();
        database.when_log_is_long([this] { identity.advance(); });
        spdlog::info("the store {} has the id {}", settings.store.string(), identity.id());
        reserve.fill();
        for (const std::string& warning : room.warnings()) spdlog::warn("{}", warning);
        maintenance =
            std::make_unique<Maintenance>(database, identity, store, room, uploads, reserve, settings.keep_failed_s);
        scrub = std::make_unique<Scrub>(store, settings.scrub_s,
                                        [this](Sql& sql, const std::string& digest) { queue.blob_lost(sql, digest); });
        check_worker();
        pool = std::make_unique<WorkerPool>(
            queue, *runner, database, store, room,
            WorkerPoolSettings{settings.runner, settings.workers, settings.worker_threads});
    }

    const Settings settings;
    StoreFolder folder;
    Database database;
    StoreIdentity identity;
    BlobStore store;
    DiskReserve reserve;
    Room room;
    std::unique_ptr<Runner> runner, inspector;  ///< of stages, of inspections
    Queue queue;
    Bakes bakes;
    Batches batches;
    Catalog catalog;
    Names names;
    Uploads uploads;
    std::unique_ptr<Maintenance> maintenance;
    std::unique_ptr<Scrub> scrub;
    std::unique_ptr<WorkerPool> pool;
};

Service::Service(const Settings& settings)
    : Service(settings, make_runner(settings.runner, runner_settings(settings))) {}

Service::Service(const Settings& settings, std::unique_ptr<Runner> runner)
    : parts_(std::make_unique<Parts>(settings, std::move(runner))) {
    parts_->boot();
}

Service::~Service() {
    stop();
    parts_->pool.reset();
    parts_->maintenance.reset();
    parts_->scrub.reset();
    try {
        parts_->store.flush_uses();
        parts_->identity.advance();  // a copy of the database that was made before is now an old one
    } catch (const std::exception& error) {
        spdlog::error("at the end: {}", error_text(error));
    }
}

void Service::stop() {
    parts_->queue.stop();
    parts_->maintenance->stop();
    parts_->scrub->stop();
}

std::filesystem::path Service::incoming_folder() const { return parts_->store.incoming_folder(); }
const Settings& Service::settings() const { return parts_->settings; }
Bakes& Service::bakes() { return parts_->bakes; }
Batches& Service::batches() { return parts_->batches; }
Catalog& Service::catalog() { return parts_->catalog; }
Names& Service::names() { return parts_->names; }
Uploads& Service::uploads() { return parts_->uploads; }

std::optional<std::uint64_t> Service::blob_size(const std::string& digest) { return parts_->store.size_of(digest); }

std::unique_ptr<IncomingFile> Service::receive(std::optional<std::uint64_t> bytes, const std::string& digest) {
    parts_->database.check_in_place();
    const bool is_stored = is_digest(digest) && parts_->store.size_of(digest);
    const std::uint64_t limit = parts_->settings.blob_bytes;
    std::optional<Room::Share> share;
    try {
        share.emplace(parts_->room.reserve(bytes, is_stored));
    } catch (const Refusal&) {  // the disk has no room
        if (!is_stored) throw;
        return std::make_unique<IncomingFile>(limit);
    }
    return std::make_unique<IncomingFile>(parts_->store.incoming_folder(), limit, std::move(share),
                                          is_stored ? WhenFull::compare : WhenFull::refuse);
}

/// A body whose bytes are stored already, and which was not written since the disk has no room.
void Service::confirm_stored(const std::string& digest) try {
    open_blob(digest);
    const auto held = parts_->database.lock();
    if (!parts_->store.size_of(digest)) throw Refusal(Refused::not_found, "it was deleted meanwhile");
    parts_->store.note_sent(digest);
} catch (const Refusal& refusal) {
    if (refusal.why() != Refused::not_found) throw;
    throw Refusal(Refused::busy, std::string("the disk has no room for the body, and the stored file is gone: ") +
                                     refusal.what() + ". Make room on the disk, then send the file again");
}

bool Service::store_blob(IncomingFile& file, const std::string& expected_digest) {
    parts_->store.check(file, expected_digest);
    if (!file.has_file()) {
        confirm_stored(file.digest());
        return false;
    }
    const auto held = parts_->database.lock();
    if (!parts_->store.size_of(file.digest())) file.count();  // it may have been stored when the body began
    const bool is_new = parts_->store.adopt(file.path(), file.digest(), Origin::sent);
    file.give_back();
    return is_new;
}

OpenBlob Service::open_blob(const std::string& digest) try {
    return parts_->store.open(digest, [&](Sql& sql) { parts_->queue.blob_lost(sql, digest); });
} catch (const LostBlob& lost) {
    spdlog::error("{}", lost.what());
    // Waiting brings back what is baked again. All else is unknown to the next request.
    throw Refusal(lost.comes_back() ? Refused::busy : Refused::not_found, lost.what());
}

std::string Service::list_blobs(const std::string& cursor, int limit, bool unneeded) {
    return list_sent_blobs(parts_->database, cursor, limit, unneeded);
}

void Service::remove_input(const std::string& kind, const std::string& digest, bool force) {
    parts_->reserve.run([&] { hairbake::remove_input(parts_->store, kind, digest, force); });
}

void Service::remove_blob(const std::string& digest, bool force) {
    parts_->reserve.run([&] { hairbake::remove_blob(parts_->store, digest, force); });
}

void Service::remove_upload(const std::string& id) { parts_->uploads.remove(id); }

Catalog::Added Service::add_input(const std::string& kind, const std::string& digest) {
    try {
        if (parts_->store.size_of(digest)) open_blob(digest);  // verifies it: facts of spoiled bytes must not be kept
    } catch (const Refusal& refusal) {
        if (refusal.why() != Refused::not_found) throw;
        throw Refusal(Refused::unprocessable, refusal.what(), "sha256");  // as Catalog::add() of an unknown digest
    }
    return parts_->catalog.add(kind, digest);
}

/// The answer to a repeated request for a done bake. It writes nothing and does not wait for the writer.
std::optional<Service::Answer> Service::answer_if_done(const std::string& body) {
    std::optional<Answer> answer;
    parts_->database.read([&](Sql& sql) {
        const AskedBake asked = read_bake_request(sql, body);
        const std::string id = bake_id_of(asked.request);
        if (parts_->queue.note_done(sql, id, asked.names))
            answer = {id, JobState::done, parts_->bakes.get(id).json, asked.warnings};
    });
    return answer;
}

Service::Answer Service::submit(const std::string& body) {
    if (std::optional<Answer> known = answer_if_done(body)) return *known;
    const auto held = parts_->database.lock();  // a blob that is stored now is still stored when the bake is queued
    AskedBake asked;
    BakePlan plan;
    parts_->database.read([&](Sql& sql) {
        asked = read_bake_request(sql, body);
        plan = plan_bake(sql, asked);
    });
    const Submitted submitted = parts_->queue.submit({plan}).at(0);
    return {submitted.id, submitted.state, parts_->bakes.get(submitted.id).json, asked.warnings};
}

std::string Service::not_ready() {
    if (parts_->queue.stopping()) return "the service is stopping";
    if (const std::string reason = parts_->queue.paused().reason; !reason.empty())
        return "the queue is paused and tries again by itself: " + reason;
    try {
        parts_->database.check_in_place();
        parts_->identity.check_recorded();
        parts_->folder.check_usable();
        parts_->store.check_folders();
        IncomingFile probe(parts_->store.incoming_folder(), 16);
        probe.add(std::as_bytes(std::span("ready", 5)));
        parts_->database.read([](Sql& sql) { sql.rows("SELECT count(*) FROM names"); });
        parts_->runner->check_ready();
        parts_->inspector->check_ready();
    } catch (const std::exception& error) {
        return error_text(error);
    }
    return {};
}

int Service::seconds_until_retry() {
    const Queue::Pause pause = parts_->queue.paused();
    constexpr int usual_s = 5;
    return pause.reason.empty() ? usual_s : std::max(1, static_cast<int>(std::ceil(pause.next_try_s)));
}

std::vector<std::string> Service::warnings() { return parts_->room.warnings(); }

void Service::cancel(const std::string& bake) {
    parts_->reserve.run([&] { parts_->queue.cancel(bake); });
}

Service::Counts Service::counts() {
    Counts counts;
    const Queue::Pause pause = parts_->queue.paused();
    counts.paused = pause.reason;
    counts.troubles = pause.troubles;
    for (const auto& [state, name] : job_states) counts.stages[state] = counts.bakes[state] = 0;
    const auto add = [](std::map<JobState, std::int64_t>& to, const std::vector<SqlRow>& rows) {
        for (const SqlRow& row : rows)
            if (const auto state = job_state(row.text(0))) to[*state] = row.integer(1);
    };
    parts_->database.read([&](Sql& sql) {
        add(counts.stages, sql.rows("SELECT state, count(*) FROM stages GROUP BY state"));
        add(counts.bakes, sql.rows("SELECT state, count(*) FROM bakes GROUP BY state"));
        const SqlRow blobs = sql.rows("SELECT count(*), sum(bytes) FROM blobs").at(0);
        counts.blobs = static_cast<std::uint64_t>(blobs.integer(0));
        counts.bytes = static_cast<std::uint64_t>(blobs.integer(1));
    });
    return counts;
}

}  // namespace hairbake
