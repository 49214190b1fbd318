// The periodic work on the store.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

namespace hairbake {

class BlobStore;
class Database;
class DiskReserve;
class Room;
class StoreIdentity;
class Uploads;

/// A thread that, once a minute, records the uses of blobs and the store's generation, removes expired uploads and old
/// failed bakes, keeps the store within its budget, and fills the reserve. Old failed bakes are removed by the
/// constructor, too.
class Maintenance {
public:
    /// `keep_failed_s`: how long failed and cancelled bakes are kept.
    Maintenance(Database& database, StoreIdentity& identity, BlobStore& store, Room& room, Uploads& uploads,
                DiskReserve& reserve, double keep_failed_s);
    ~Maintenance();

    /// Tells the thread to end; returns at once.
    void stop();

private:
    void run();
    void prune_bakes();

    Database& database_;
    StoreIdentity& identity_;
    BlobStore& store_;
    Room& room_;
    Uploads& uploads_;
    DiskReserve& reserve_;
    const double keep_failed_s_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_stopping_ = false;  ///< guarded by mutex_
    std::jthread thread_;
};

}  // namespace hairbake
