// Re-baking many grooms under another lighting.
#pragma once

#include <string>

#include "server/jobs/kept_views.h"
#include "server/jobs/queue.h"

namespace hairbake {

/// Thread-safe. Answers are JSON objects.
class Batches {
public:
    Batches(Database& database, Queue& queue) : database_(database), queue_(queue), views_(database) {}

    /// `text`: {"environment": NEW, and one of "bakes": [ids], "replaces": ENVIRONMENT, "name": NAME, "models": [...],
    /// and optionally "irradiance": {...}, "priority"}. Each affected bake is asked for again with the new environment;
    /// "replaces" and "name" mean the bakes under that environment (digest, or path of an environment's name), "models"
    /// the newest bake of each model; all three leave out what failed or was cancelled. With `dry_run` nothing is
    /// queued and the answer tells how many of the bakes are done already, and what would be reused and computed.
    /// Throws Refusal.
    std::string rebake(const std::string& text, bool dry_run);

    /// How many of its bakes are in which state. Throws Refusal(not_found).
    std::string get(const std::string& id);

private:
    Database& database_;
    Queue& queue_;
    KeptViews<std::string> views_;
};

}  // namespace hairbake
