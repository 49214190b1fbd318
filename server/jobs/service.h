// The whole service behind the HTTP rim: store, queue and workers, in the order in which they start and stop.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "server/jobs/bakes.h"
#include "server/jobs/batches.h"
#include "server/jobs/catalog.h"
#include "server/jobs/local_runner.h"
#include "server/jobs/names.h"
#include "server/jobs/queue.h"
#include "server/jobs/slots.h"
#include "server/jobs/uploads.h"
#include "server/settings.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/eviction.h"
#include "server/store/refusal.h"

namespace hairbake {

/// Only one process at a time holds a store. Thread-safe.
class Service {
public:
    /// Boots: lock, database, store, queue; then the workers. Throws Error.
    explicit Service(const Settings& settings);
    /// Ends the workers; what they did is queued again.
    ~Service();

    // ---- blobs
    /// A file to receive a body into, of that digest where it is known. Makes room for it; throws Refusal(full) when
    /// `expected_bytes` cannot be taken.
    std::unique_ptr<IncomingFile> receive(std::uint64_t expected_bytes, const std::string& digest = {});
    /// Makes the received file a blob; returns whether it is new. Throws Refusal(unprocessable) when `expected_digest`
    /// is not empty and another one, and Refusal(full) when there is no room for it.
    bool store_blob(IncomingFile& file, const std::string& expected_digest);
    /// Opens a blob, verified. A spoiled one starts its stages again and is Refusal(busy) for a result, not_found else.
    OpenBlob open_blob(const std::string& digest);

    /// Catalog::add() of verified bytes; throws as open_blob() too.
    Catalog::Added add_input(const std::string& kind, const std::string& digest);

    // ---- bakes
    /// {"id", "state"...} as Bakes::get, and whether it was done before.
    struct Answer {
        std::string id, state, json;
    };
    Answer submit(const std::string& body);

    // ---- health
    /// Empty when the store can be written and the database answers; else what is wrong.
    std::string not_ready();
    /// Counts for /metrics.
    struct Counts {
        std::map<std::string, std::int64_t> stages, bakes;  ///< by state
        std::uint64_t blobs = 0, bytes = 0;
    };
    Counts counts();

    const Settings& settings() const { return settings_; }
    Database& database() { return database_; }
    Queue& queue() { return queue_; }
    Bakes& bakes() { return bakes_; }
    Batches& batches() { return batches_; }
    Catalog& catalog() { return catalog_; }
    Uploads& uploads() { return uploads_; }
    std::optional<std::uint64_t> blob_size(const std::string& digest) { return store_.size_of(digest); }

    /// Tells slots and requests to end; returns at once.
    void stop();

private:
    std::optional<Answer> answer_if_done(const std::string& body);
    void look_after();

    const Settings settings_;
    Descriptor lock_;
    Database database_;
    BlobStore store_;
    LocalRunner runner_;
    Queue queue_;
    Bakes bakes_;
    Batches batches_;
    Catalog catalog_;
    Uploads uploads_;
    std::unique_ptr<Slots> slots_;
    std::mutex mutex_;
    std::condition_variable_any stopped_;
    std::jthread caretaker_;
};

}  // namespace hairbake
