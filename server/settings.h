// config/hairbake.toml: everything that can be set, with its default.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hairbake {

/// Who may do what. The token itself is stored nowhere.
struct TokenSettings {
    std::string name;                 ///< stands in logs and beside what was made with it
    std::string sha256;               ///< of the token's text
    std::vector<std::string> scopes;  ///< of read, upload, bake, admin
    std::optional<double> expires;    ///< seconds since 1970
};

struct Settings {
    // [listen]
    std::string socket;                 ///< Unix socket; when empty, address and port hold
    std::string address = "127.0.0.1";  ///< loopback only: the network's side is nginx's
    int port = 8080;                    ///< 0: any free one
    int threads = 64;                   ///< requests at once; nginx passes on up to 48 uploads
    int waiting = 256;                  ///< connections that may wait for a thread; then 503
    std::string accel;                  ///< nginx's internal location of store/blobs, which sends files; or empty
    // [store]
    std::filesystem::path store = "store";
    std::uint64_t budget_bytes = 200ull << 30;
    std::uint64_t blob_bytes = 4ull << 30;  ///< of one blob or upload
    double upload_lifetime_s = 24 * 3600;   ///< of an upload that does not grow
    int open_uploads = 256;                 ///< unfinished uploads of one token
    double keep_failed_s = 30 * 86400;      ///< how long failed and cancelled bakes and ended batches are remembered
    // [workers]
    std::filesystem::path worker;  ///< hairbake-worker; by default beside the daemon
    int workers = 0;               ///< at once; 0: half the cores, at least 1
    int worker_threads = 0;        ///< of each; 0: cores / workers, at least 1
    std::uint64_t memory_bytes = 8ull << 30;
    std::uint64_t cpu_seconds = 4 * 3600;
    double wall_seconds = 2 * 3600;
    int max_crashes = 5;  ///< how often a stage starts again after a death without a word
    // [web]
    std::optional<std::filesystem::path>
        web;  ///< folder of the page; empty: none; by default what lies beside the daemon
    // [[token]]
    std::vector<TokenSettings> tokens;
};

/// Reads the file over the defaults; relative paths are the file's neighbours. Throws Error(usage) naming file, field
/// and what is allowed, also for a field that does not exist.
Settings read_settings(const std::filesystem::path& file);

/// Fills in what depends on the machine (workers, threads, the worker's place) and checks ranges. Throws Error(usage).
void complete(Settings& settings);

}  // namespace hairbake
