#include "server/jobs/service.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>

#include "core/base/error.h"
#include "server/jobs/bake_request.h"
#include "server/store/pruning.h"

namespace hairbake {
namespace {

Descriptor lock_store(const std::filesystem::path& folder) {
    make_folder(folder);
    Descriptor lock(::open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0640));
    if (!lock) throw_store_error(folder / "lock", errno);
    if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0)
        throw Error(ErrorKind::usage, "another hairbaked works on the store " + folder.string());
    return lock;
}

}  // namespace

Service::Service(const Settings& settings)
    : settings_(settings),
      lock_(lock_store(settings.store)),
      database_(settings.store / "hairbake.db"),
      store_(settings.store, database_),
      runner_({settings.worker, settings.memory_bytes, settings.cpu_seconds, settings.wall_seconds}),
      queue_(database_, store_, settings.max_crashes),
      bakes_(database_, queue_),
      batches_(database_, queue_),
      catalog_(database_, store_, runner_),
      uploads_(database_, store_, settings.store / "uploads",
               {settings.upload_lifetime_s, settings.blob_bytes, settings.budget_bytes, settings.open_uploads}) {
    if (const std::size_t lost = store_.recover()) spdlog::warn("{} blobs were lost", lost);
    uploads_.recover();
    if (const std::size_t lost = queue_.recover()) spdlog::warn("{} stages lost files; they are baked again", lost);
    prune(database_, now() - settings_.keep_failed_s);
    slots_ = std::make_unique<Slots>(queue_, runner_, database_, store_, settings_.budget_bytes, settings_.workers,
                                     settings_.worker_threads);
    caretaker_ = std::jthread([this] { look_after(); });
}

Service::~Service() {
    stop();
    slots_.reset();
    caretaker_ = {};
    try {
        store_.flush_uses();
    } catch (const std::exception& error) {
        spdlog::error("at the end: {}", error.what());
    }
}

void Service::stop() {
    queue_.stop();
    stopped_.notify_all();
}

/// Once a minute: uses are written down, old uploads and ends go, the budget is kept.
void Service::look_after() {
    std::unique_lock lock(mutex_);
    while (!stopped_.wait_for(lock, std::chrono::seconds(60), [this] { return queue_.stopping(); })) try {
            store_.flush_uses();
            uploads_.expire();
            prune(database_, now() - settings_.keep_failed_s);
            evict(database_, store_, settings_.budget_bytes);
        } catch (const std::exception& error) {
            spdlog::error("caretaker: {}", error.what());
        }
}

std::unique_ptr<IncomingFile> Service::receive(std::uint64_t expected_bytes, const std::string& digest) {
    if (expected_bytes > settings_.blob_bytes)
        throw Refusal(Refused::too_large, "the body is " + std::to_string(expected_bytes) +
                                              " bytes long; allowed is up to " + std::to_string(settings_.blob_bytes));
    const bool known = is_digest(digest) && store_.size_of(digest);  // then nothing more will lie here
    if (!known) make_room(database_, store_, settings_.budget_bytes, expected_bytes);
    return std::make_unique<IncomingFile>(store_.incoming_folder(), settings_.blob_bytes);
}

/// There is room for what was announced, and a body in chunks announces nothing; others came meanwhile, too.
bool Service::store_blob(IncomingFile& file, const std::string& expected_digest) {
    store_.check(file, expected_digest);
    const auto held = database_.lock();
    if (!store_.size_of(file.digest())) make_room(database_, store_, settings_.budget_bytes, file.bytes());
    return store_.adopt(file.path(), file.digest());
}

OpenBlob Service::open_blob(const std::string& digest) try {
    return store_.open(digest, [&](Sql& sql) { queue_.blob_lost(sql, digest); });
} catch (const LostBlob& lost) {
    spdlog::error("{}", lost.what());
    throw Refusal(Refused::busy, std::string(lost.what()) + "; a result is baked again, an input must be sent again");
}

Catalog::Added Service::add_input(const std::string& kind, const std::string& digest) {
    if (store_.size_of(digest)) open_blob(digest);  // facts are kept for good: not those of spoiled bytes
    return catalog_.add(kind, digest);
}

/// A build farm that asks again: nothing is written, and nobody waits for who writes.
std::optional<Service::Answer> Service::answer_if_done(const std::string& body) {
    std::optional<Answer> answer;
    database_.read([&](Sql& sql) {
        const AskedBake asked = read_bake_request(sql, body);
        const std::string id = bake_id_of(asked.request);
        if (queue_.note_done(sql, id, asked.names)) answer = {id, "done", bakes_.get(id).json};
    });
    return answer;
}

Service::Answer Service::submit(const std::string& body) {
    if (std::optional<Answer> known = answer_if_done(body)) return *known;
    const auto held = database_.lock();  // what was found stored stays stored until it is queued
    BakePlan plan;
    database_.read([&](Sql& sql) { plan = plan_bake(sql, read_bake_request(sql, body)); });
    const Submitted submitted = queue_.submit({plan}).at(0);
    return {submitted.id, submitted.state, bakes_.get(submitted.id).json};
}

std::string Service::not_ready() {
    if (queue_.stopping()) return "the service is stopping";
    try {
        IncomingFile probe(store_.incoming_folder(), 16);
        probe.add(std::as_bytes(std::span("ready", 5)));
        database_.read([](Sql& sql) { sql.rows("SELECT count(*) FROM names"); });
    } catch (const std::exception& error) {
        return error.what();
    }
    if (::access(settings_.worker.c_str(), X_OK) != 0) return "the worker program cannot be started";
    return {};
}

Service::Counts Service::counts() {
    Counts counts;
    for (const char* state : {"queued", "running", "done", "failed", "cancelled"})
        counts.stages[state] = counts.bakes[state] = 0;
    database_.read([&](Sql& sql) {
        for (const SqlRow& row : sql.rows("SELECT state, count(*) FROM stages GROUP BY state"))
            counts.stages[row.text(0)] = row.integer(1);
        for (const SqlRow& row : sql.rows("SELECT state, count(*) FROM bakes GROUP BY state"))
            counts.bakes[row.text(0)] = row.integer(1);
        const SqlRow blobs = sql.rows("SELECT count(*), sum(bytes) FROM blobs").at(0);
        counts.blobs = static_cast<std::uint64_t>(blobs.integer(0));
        counts.bytes = static_cast<std::uint64_t>(blobs.integer(1));
    });
    return counts;
}

}  // namespace hairbake
