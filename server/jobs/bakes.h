// Bakes as the HTTP interface shows them: views, lists, files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/jobs/job_state.h"
#include "server/jobs/view_cache.h"

namespace hairbake {

class Database;
class Queue;

/// Empty fields do not filter.
struct BakeFilter {
    std::optional<JobState> state{};
    std::string model{}, environment{}, name{}, batch{};  ///< digests, a name's path, a batch's id
    std::int64_t cursor = INT64_MAX;
    int limit = 50;
};

/// A file of a finished bake: a blob, or the manifest as text.
struct BakeFile {
    std::string name, etag;  ///< digest of the bytes
    std::optional<std::string> blob;
    std::string text;
};

/// A bake as a JSON object, and the text's digest.
struct BakeView {
    std::string json, digest;
};

/// Thread-safe. Answers are JSON objects.
class Bakes {
public:
    Bakes(Database& database, Queue& queue) : database_(database), queue_(queue) {}

    /// Throws Refusal(not_found, or gone for a bake that was removed).
    BakeView get(const std::string& id);
    /// {"bakes": [...], "next": cursor or null}, newest first, without their requests.
    std::string list(const BakeFilter& filter);
    /// Throws Refusal(not_found, or gone for a bake that was removed).
    /// Throws Refusal(conflict) while the bake is not done.
    BakeFile file(const std::string& id, const std::string& name);

private:
    Database& database_;
    Queue& queue_;
    ViewCache<BakeView> done_;  ///< of done bakes alone: the progress of others is not in the database
};

}  // namespace hairbake
