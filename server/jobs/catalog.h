// Models and environments: blobs whose facts and thumbnail a worker has read.
#pragma once

#include <cstdint>
#include <semaphore>
#include <string>

namespace hairbake {

class BlobStore;
class Database;
class Runner;
class WorkFolder;
struct Outcome;

/// Thread-safe. `kind` is "model" or "environment". Answers are JSON objects.
class Catalog {
public:
    Catalog(Database& database, BlobStore& store, Runner& runner);

    struct Added {
        std::string answer;
        bool known = false;
    };
    /// Has a worker read the blob, unless that was done before. The caller has checked the blob's digest.
    /// Throws Refusal(unprocessable) with the worker's message when the file cannot be read.
    /// Throws Refusal(busy) while the machine is in trouble: the file is not at fault.
    /// Throws Error for other failures.
    Added add(const std::string& kind, const std::string& digest);
    std::string get(const std::string& kind, const std::string& digest);
    /// {"models": [...], "next": cursor or null}, newest first.
    std::string list(const std::string& kind, std::int64_t cursor, int limit);
    /// Digest of the thumbnail's blob.
    /// Throws Refusal(not_found).
    std::string thumbnail(const std::string& kind, const std::string& digest);

private:
    void inspect(const std::string& kind, const std::string& digest);
    Outcome run(const WorkFolder& folder);

    Database& database_;
    BlobStore& store_;
    Runner& runner_;
    static constexpr int most_readers = 2;
    std::counting_semaphore<most_readers> readers_{most_readers};
};

}  // namespace hairbake
