// What can be asked about bakes, and their files.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include "server/jobs/queue.h"

namespace hairbake {

/// Empty fields do not filter.
struct BakeFilter {
    std::string state, model, environment, name, batch;  ///< digests, a name's path, a batch's id
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

    /// Throws Refusal(not_found).
    BakeView get(const std::string& id);
    /// {"bakes": [...], "next": cursor or null}, newest first, without their requests.
    std::string list(const BakeFilter& filter);
    /// Throws Refusal(not_found); Refusal(conflict) while the bake is not done.
    BakeFile file(const std::string& id, const std::string& name);

private:
    /// Views of done bakes at one version of the database: they are asked for again and again.
    struct Views {
        std::uint64_t version = 0;
        std::unordered_map<std::string, BakeView> of;
    };
    std::optional<BakeView> known_view(const std::string& id);
    void keep_view(std::uint64_t version, const std::string& id, const BakeView& view);

    Database& database_;
    Queue& queue_;
    std::mutex mutex_;  ///< of the views
    Views views_;
};

}  // namespace hairbake
