// Models and environments: blobs that a worker has read.
#pragma once

#include <cstdint>
#include <semaphore>
#include <string>

#include "server/jobs/runner.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"

namespace hairbake {

/// Thread-safe. `kind` is "model" or "environment". Answers are JSON objects.
class Catalog {
public:
    Catalog(Database& database, BlobStore& store, Runner& runner);

    struct Added {
        std::string answer;
        bool known = false;
    };
    /// Has a worker read the blob, whose digest was checked, unless that was done before. Throws Refusal(unprocessable)
    /// with the worker's words, Error for what is not the file's fault.
    Added add(const std::string& kind, const std::string& digest);
    std::string get(const std::string& kind, const std::string& digest);
    /// {"models": [...], "next": cursor or null}, newest first.
    std::string list(const std::string& kind, std::int64_t cursor, int limit);
    /// Digest of the thumbnail's blob. Throws Refusal(not_found).
    std::string thumbnail(const std::string& kind, const std::string& digest);
    /// Forgets it, and its blob unless that is needed otherwise. Throws Refusal(conflict) while a live bake uses it or
    /// a name points at it.
    void remove(const std::string& kind, const std::string& digest);

private:
    void inspect(const std::string& kind, const std::string& digest);

    Database& database_;
    BlobStore& store_;
    Runner& runner_;
    std::counting_semaphore<2> readers_{2};
};

}  // namespace hairbake
