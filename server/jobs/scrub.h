// The slow check of all stored bytes.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "server/store/blob_store.h"

namespace hairbake {

/// A thread that reads every blob once in a period and compares its digest, the one checked longest ago first. So bytes
/// that rot on the disk are found although nobody asks for them, and are not served.
class Scrub {
public:
    /// Called in the transaction that forgets a spoiled blob, with its digest.
    using OnLoss = std::function<void(Sql&, const std::string&)>;

    /// `period_s` is in seconds; 0: nothing is checked.
    Scrub(BlobStore& store, double period_s, OnLoss on_loss);
    ~Scrub();

    /// Tells the thread to end; returns at once.
    void stop();

private:
    struct Stopped {};
    void run();
    void check_due();
    void check(const std::string& digest);
    void pause(double seconds);

    BlobStore& store_;
    const double period_s_;
    const OnLoss on_loss_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_stopping_ = false;  ///< guarded by mutex_
    std::jthread thread_;
};

}  // namespace hairbake
