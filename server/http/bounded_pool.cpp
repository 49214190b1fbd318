#include "server/http/bounded_pool.h"

namespace hairbake {
namespace {

constexpr std::size_t most_refusals = 1024;
thread_local bool refusing = false;

}  // namespace

BoundedPool::BoundedPool(int threads, int waiting) : waiting_(static_cast<std::size_t>(waiting)) {
    const auto add = [this](Line& line, bool refuses) {
        std::condition_variable& woken = *sleepers_.emplace_back(std::make_unique<std::condition_variable>());
        threads_.emplace_back([this, &line, &woken, refuses] {
            refusing = refuses;
            work(line, woken);
        });
    };
    try {
        for (int i = 0; i < threads; ++i) add(accepted_, false);
        add(refused_, true);
    } catch (...) {
        shutdown();  // those that were made wait for jobs
        throw;
    }
}

BoundedPool::~BoundedPool() { shutdown(); }

bool BoundedPool::is_refusing() { return refusing; }

bool BoundedPool::enqueue(std::function<void()> job) {
    std::condition_variable* sleeper = nullptr;
    {
        const std::lock_guard lock(mutex_);
        Line& line = accepted_.jobs.size() < waiting_ ? accepted_ : refused_;
        if (&line == &refused_ && line.jobs.size() >= most_refusals) return false;
        line.jobs.push_back(std::move(job));
        if (!line.idle.empty()) {
            sleeper = line.idle.back();
            line.idle.pop_back();
        }
    }
    if (sleeper) sleeper->notify_one();  // not under the lock, which it needs at once
    return true;
}

void BoundedPool::shutdown() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    for (const auto& sleeper : sleepers_) sleeper->notify_one();
    threads_.clear();  // joins
}

void BoundedPool::work(Line& line, std::condition_variable& woken) {
    for (;;) {
        std::unique_lock lock(mutex_);
        while (!ending_ && line.jobs.empty()) {
            line.idle.push_back(&woken);
            woken.wait(lock);
            std::erase(line.idle, &woken);  // still there when it woke by itself
        }
        if (line.jobs.empty()) return;
        const std::function<void()> job = std::move(line.jobs.front());
        line.jobs.pop_front();
        lock.unlock();
        job();
    }
}

}  // namespace hairbake
