// The settings of the daemon: config/hairbake.toml, with the default of each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/scope.h"

namespace hairbake {

/// A token and its rights. The token's text is stored nowhere.
struct TokenSettings {
    std::string name;               ///< in logs, and stored with the names and uploads that it made
    std::string sha256;             ///< of the token's text
    std::set<Scope> scopes;         ///< of read, upload, bake, admin
    std::optional<double> expires;  ///< seconds since 1970
};

struct Settings {
    // [listen]
    std::string socket;                 ///< Unix socket; when empty, address and port hold
    std::string address = "127.0.0.1";  ///< loopback only; nginx exposes the service
    int port = 8080;                    ///< 0: any free one
    int threads = 64;                   ///< requests at once
    int bodies = 48;                    ///< uploads and long JSON bodies at once; then 429
    int bodies_per_address = 16;        ///< of those, from one address that nginx names
    std::uint64_t body_rate = 1024;     ///< bytes a second that a body must bring; 0: any; then 408
    double body_window_s = 30;          ///< over which that is averaged
    int waiting = 256;                  ///< connections that may wait for a thread; then 503
    std::string accel;  ///< nginx's internal location of store/blobs, from which nginx sends files; or empty
    // [store]
    std::filesystem::path store = "store";
    std::string store_id;  ///< of the store that must be there; empty: any, and an empty folder becomes one
    std::uint64_t budget_bytes = 200ull << 30;
    std::uint64_t keep_free_bytes = 1ull << 30;  ///< of the disk, that uploads leave free
    std::uint64_t blob_bytes = 4ull << 30;       ///< limit of one blob or upload
    double upload_lifetime_s = 24 * 3600;        ///< of an upload that receives nothing
    int open_uploads = 256;                      ///< unfinished uploads of one token
    double scrub_s = 7 * 86400;                  ///< each blob's digest is checked once in this time; 0: never
    double keep_failed_s = 30 * 86400;           ///< how long failed and cancelled bakes and ended batches are kept
    // [workers]
    std::string runner = "local";  ///< of runner_names()
    std::filesystem::path
        worker;              ///< hairbake-worker; by default beside the daemon; while it is away, the queue pauses
    int workers = 0;         ///< at once; 0: half the cores, at least 1
    int worker_threads = 0;  ///< of each; 0: cores / workers, at least 1
    std::uint64_t memory_bytes = 8ull << 30;
    std::uint64_t cpu_seconds = 4 * 3600;
    double wall_seconds = 2 * 3600;
    int max_crashes = 5;      ///< retries after the worker process crashes or is killed
    double crash_wait_s = 2;  ///< before the first of these retries; later waits grow. 0: no waits
    // [web]
    std::optional<std::filesystem::path>
        web;  ///< folder of the page; empty: no page; by default the one beside the daemon
    // [[token]]
    std::vector<TokenSettings> tokens;
};

/// Reads the file over the defaults. Relative paths are relative to the file's folder.
/// Throws Error(usage) naming file, field and what is allowed, also for an unknown field.
Settings read_settings(const std::filesystem::path& file);

/// Fills in the defaults that depend on the machine (workers, threads, the worker's path) and checks all values.
/// Throws Error(usage).
void complete(Settings& settings);

}  // namespace hairbake
