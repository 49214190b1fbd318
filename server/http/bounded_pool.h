// The threads that answer requests: a fixed number, behind a queue that does not grow without end.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace hairbake {

/// Thread-safe. Jobs run in the order in which they came; one that finds `waiting` jobs before it is run by one more
/// thread, which only refuses (is_refusing()). The thread that became idle last takes the next job: its stack and its
/// memory are still in the cache, and the threads that a quiet service does not need sleep on.
class BoundedPool {
public:
    /// threads, waiting: at least 1.
    BoundedPool(int threads, int waiting);
    ~BoundedPool();

    /// False, and nothing is run, when not even the refusing thread has room for the job.
    bool enqueue(std::function<void()> job);
    /// Returns when all that was enqueued has run and every thread has ended. Not to be called beside enqueue().
    void shutdown();
    /// Whether the job that asks was one too many.
    static bool is_refusing();

private:
    struct Line {
        std::deque<std::function<void()>> jobs;
        std::vector<std::condition_variable*> idle;  ///< of sleeping threads; the last is woken first
    };

    void work(Line& line, std::condition_variable& woken);

    const std::size_t waiting_;
    std::mutex mutex_;
    bool ending_ = false;
    Line accepted_, refused_;
    std::vector<std::unique_ptr<std::condition_variable>> sleepers_;  ///< one of each thread
    std::vector<std::jthread> threads_;
};

}  // namespace hairbake
