// The periodic work on the store.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

namespace hairbake {

class BlobStore;
class Database;
class StoreIdentity;
class Uploads;

struct MaintenanceSettings {
    double keep_failed_s = 0;  ///< how long failed and cancelled bakes are kept
    std::uint64_t budget = 0;  ///< of the store, in bytes
};

/// A thread that, once a minute, records the uses of blobs and the store's generation, removes expired uploads and old
/// failed bakes, and keeps the store within its budget. Old failed bakes are removed by the constructor, too.
class Maintenance {
public:
    Maintenance(Database& database, StoreIdentity& identity, BlobStore& store, Uploads& uploads,
                const MaintenanceSettings& settings);
    ~Maintenance();

    /// Tells the thread to end; returns at once.
    void stop();

private:
    void run();
    void prune_bakes();

    Database& database_;
    StoreIdentity& identity_;
    BlobStore& store_;
    Uploads& uploads_;
    const MaintenanceSettings settings_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_stopping_ = false;  ///< guarded by mutex_
    std::jthread thread_;
};

}  // namespace hairbake
