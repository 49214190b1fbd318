// The whole service behind the HTTP interface: store, queue and workers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/jobs/bakes.h"
#include "server/jobs/batches.h"
#include "server/jobs/catalog.h"
#include "server/jobs/job_state.h"
#include "server/jobs/names.h"
#include "server/jobs/runner.h"
#include "server/jobs/uploads.h"
#include "server/settings.h"
#include "server/store/blob_store.h"
#include "server/store/refusal.h"

namespace hairbake {

/// Only one process at a time holds a store. Thread-safe.
class Service {
public:
    /// Boots: lock, database, store, queue, workers, with the runner of the settings.
    /// Throws Error.
    explicit Service(const Settings& settings);
    /// The same with another runner, whose name is settings.runner.
    Service(const Settings& settings, std::unique_ptr<Runner> runner);
    /// Stops the workers; their stages are queued again. Workers of a runner that survives a restart go on.
    ~Service();

    // ---- blobs
    /// A file to receive a body of `bytes` into, or of unknown length. Its room is reserved until the file is gone. A
    /// body of the blob `digest` needs none in the budget if that is stored, and on a full disk no file.
    /// Throws Refusal(full) when there is no room.
    /// Throws Refusal(busy) when the store was moved, deleted or replaced.
    std::unique_ptr<IncomingFile> receive(std::optional<std::uint64_t> bytes, const std::string& digest = {});

    /// Makes the received file a blob; returns whether it is new.
    /// Throws Refusal(unprocessable) when `expected_digest` is not empty and not the file's.
    /// Throws Refusal(full) when the blob was stored while the body began, is no longer, and has no room.
    bool store_blob(IncomingFile& file, const std::string& expected_digest);

    /// Opens a blob, verified. A spoiled result is baked again.
    /// Throws Refusal(not_found), also for a spoiled input: it must be sent again.
    /// Throws Refusal(busy) for a spoiled result, and for a file that cannot be read now.
    OpenBlob open_blob(const std::string& digest);
    std::optional<std::uint64_t> blob_size(const std::string& digest);

    /// As sent_blobs.h tells.
    std::string list_blobs(const std::string& cursor, int limit, bool unneeded);

    /// As input_removal.h tells; `kind` is "model" or "environment".
    void remove_input(const std::string& kind, const std::string& digest, bool force);
    void remove_blob(const std::string& digest, bool force);
    /// As Uploads::remove().
    void remove_upload(const std::string& id);

    /// Catalog::add() of verified bytes. Throws as open_blob(), too.
    Catalog::Added add_input(const std::string& kind, const std::string& digest);

    // ---- bakes
    struct Answer {
        std::string id;
        JobState state = JobState::queued;
        std::string json;                   ///< as Bakes::get()
        std::vector<std::string> warnings;  ///< of deprecated fields in the request
    };
    /// Takes a request for a bake.
    /// Throws Refusal.
    Answer submit(const std::string& body);

    /// Throws Refusal(not_found or gone).
    /// Throws Refusal(conflict) when the bake has ended.
    void cancel(const std::string& bake);

    // ---- health
    /// Empty when the store and the database can be written, workers can be started and the queue is not paused; else
    /// the reason.
    std::string not_ready();
    /// While the queue is paused: seconds until its next try, at least 1; else 5, the usual time to ask again.
    int seconds_until_retry();
    /// What an operator should know although the service is ready: see Room::warnings().
    std::vector<std::string> warnings();

    /// For /metrics.
    struct Counts {
        std::map<JobState, std::int64_t> stages, bakes;
        std::uint64_t blobs = 0, bytes = 0;
        std::string paused;          ///< why the queue is paused, or empty
        std::uint64_t troubles = 0;  ///< how often the machine kept a stage from running since the start
    };
    Counts counts();

    const Settings& settings() const;
    std::filesystem::path incoming_folder() const;  ///< of files that are under way; emptied at boot
    Bakes& bakes();
    Batches& batches();
    Catalog& catalog();
    Names& names();
    Uploads& uploads();

    /// Tells the worker pool to end; returns at once.
    void stop();

private:
    struct Parts;
    std::optional<Answer> answer_if_done(const std::string& body);
    void confirm_stored(const std::string& digest);

    const std::unique_ptr<Parts> parts_;
};

}  // namespace hairbake
