// Batches: bakes of many hair models under a new lighting.
#pragma once

#include <string>
#include <vector>

#include "server/jobs/view_cache.h"

namespace hairbake {

class Database;
class Queue;

/// Thread-safe. Answers are JSON objects.
class Batches {
public:
    Batches(Database& database, Queue& queue) : database_(database), queue_(queue) {}

    struct Rebaked {
        std::string batch;                       ///< its id; empty after a dry run
        std::string json;                        ///< the batch as get() shows it; after a dry run, the forecast
        std::vector<std::string> warnings = {};  ///< of deprecated fields in the request
    };
    /// Bakes existing bakes again under a new environment.
    ///
    /// `text` is JSON: "environment": the new one; one of "bakes": [ids], "replaces": ENVIRONMENT, "name": NAME,
    /// "models": [...]; optionally changes of lighting_blocks() and "priority". "replaces" and "name" select the bakes
    /// under that environment (a digest, or the path of an environment's name), "models" the newest bake of each model;
    /// these three leave out failed and cancelled bakes.
    /// With `dry_run` nothing is queued: the answer tells how many bakes are done already, and how many stages would be
    /// reused and computed.
    /// Throws Refusal.
    Rebaked rebake(const std::string& text, bool dry_run);

    /// The numbers of its bakes by state.
    /// Throws Refusal(not_found).
    std::string get(const std::string& id);

private:
    Database& database_;
    Queue& queue_;
    ViewCache<std::string> views_;
};

}  // namespace hairbake
