// How the threads of the worker pool take stages from the queue, and when: the pause while the machine is in trouble.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "server/jobs/queue.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/store_advice.h"

namespace hairbake {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

std::optional<ClaimedStage> Queue::claim() {
    while (!stopping_) {
        std::uint64_t seen = 0;
        bool may_try = false;
        {
            const std::lock_guard lock(mutex_);
            seen = changes_;
            if (!resumed_.empty()) {
                ClaimedStage resumed = std::move(resumed_.front());
                resumed_.pop_front();
                return resumed;
            }
            const auto time = Clock::now();
            may_try = pause_.next_try(time) <= time;
            if (may_try) pause_.begin_try(time);
        }
        if (may_try)
            if (std::optional<ClaimedStage> claimed = try_to_claim()) return claimed;
        std::unique_lock lock(mutex_);
        const auto is_changed = [&] { return stopping_ || changes_ != seen; };
        const auto time = Clock::now();
        auto next = pause_.next_try(time);
        if (next <= time) next = pause_.first_end(time);  // no stage is queued, or all of them wait
        if (next == QueuePause::Time::max())
            changed_.wait(lock, is_changed);
        else
            changed_.wait_until(lock, next, is_changed);
    }
    return std::nullopt;
}

/// claim_queued(). A database that cannot be written pauses the queue.
std::optional<ClaimedStage> Queue::try_to_claim() try { return claim_queued(); } catch (const std::exception& error) {
    const std::string reason = error_text(error);
    spdlog::error("no stage can be taken from the queue: {}", reason);
    pause("", reason);
    return std::nullopt;
}

/// The key of the first queued stage that does not wait itself; empty where there is none. While the queue is paused,
/// that is one of those with the fewest troubles.
std::string Queue::next_stage(Sql& sql) {
    const std::lock_guard lock(mutex_);
    const auto& held = pause_.held(Clock::now());
    const bool is_paused = !pause_.reason().empty();
    const auto rows = sql.rows("SELECT key FROM stages WHERE state = 'queued' ORDER BY priority DESC, seq LIMIT ?",
                               {static_cast<std::int64_t>(is_paused ? pause_.troubled() : held.size()) + 1});
    if (rows.empty()) pause_.clear();
    std::string next;
    int troubles = std::numeric_limits<int>::max();
    for (const SqlRow& row : rows) {
        const int own = is_paused ? pause_.troubles_of(row.text(0)) : 0;
        if (held.count(row.text(0)) || own >= troubles) continue;
        next = row.text(0);
        troubles = own;
    }
    return next;
}

/// Nothing when no stage is queued, or all of them wait.
std::optional<ClaimedStage> Queue::claim_queued() {
    std::optional<ClaimedStage> claimed;
    const auto held = database_.lock();  // until running_ has the stage, so that cancel() finds it
    database_.write([&](Sql& sql) {
        std::string key = next_stage(sql);
        while (!key.empty() && plan_again(sql, key)) key = next_stage(sql);
        if (key.empty()) return;
        const SqlRow row = sql.rows("SELECT kind, core_key, request, attempts FROM stages WHERE key = ?", {key}).at(0);
        claimed = {key,
                   row.text(0),
                   row.text(1),
                   row.text(2),
                   static_cast<int>(row.integer(3)) + 1,
                   std::make_shared<std::atomic<bool>>(false)};
        sql.run(
            "UPDATE stages SET state = 'running', attempts = attempts + 1, started = ?, runner = NULL, handle = NULL, "
            "work_folder = NULL WHERE key = ?",
            {now(), key});
        settle_bakes_of(sql, key);
    });
    const std::lock_guard lock(mutex_);
    if (!claimed) {
        pause_.put_off_try(Clock::now());
        return std::nullopt;
    }
    pause_.claimed(claimed->key);
    watch_.started(claimed->key);
    running_[claimed->key] = {claimed->cancel, {}};
    if (stopping_) *claimed->cancel = true;  // stop() did not see this one
    return claimed;
}

void Queue::finish_claim(const ClaimedStage& stage) {
    {
        const std::lock_guard lock(mutex_);
        running_.erase(stage.key);
    }
    wake();
}

/// The stage's end shows that the machine works.
void Queue::end_well(const ClaimedStage& stage) {
    {
        const std::lock_guard lock(mutex_);
        pause_.worked(stage.key);
        watch_.worked(stage.key);
    }
    finish_claim(stage);
}

void Queue::pause(const std::string& stage, const std::string& reason) {
    const std::lock_guard lock(mutex_);
    pause_.met_trouble(stage, reason, Clock::now());
}

Queue::Pause Queue::paused() {
    const std::lock_guard lock(mutex_);
    const auto time = Clock::now();
    const std::chrono::duration<double> wait = pause_.next_try(time) - time;
    return {pause_.reason(), std::max(0.0, wait.count()), pause_.troubles()};
}

std::string Queue::trouble_of(const std::string& stage) {
    const std::lock_guard lock(mutex_);
    const std::string own = pause_.reason_of(stage);
    return without_path(own.empty() ? pause_.reason() : own, store_.incoming_folder().parent_path());
}

}  // namespace hairbake
