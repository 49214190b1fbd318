#include "server/jobs/scrub.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "server/store/file_system.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

constexpr double bytes_per_second = 16 << 20;  // what one disk does beside its other work
constexpr int due_at_once = 4096;              // one look at all rows finds so many, one transaction records them
constexpr double longest_wait_s = 600;

}  // namespace

Scrub::Scrub(BlobStore& store, double period_s, OnLoss on_loss)
    : store_(store), period_s_(period_s), on_loss_(std::move(on_loss)) {
    if (period_s_ > 0) thread_ = std::jthread([this] { run(); });
}

Scrub::~Scrub() { stop(); }

void Scrub::stop() {
    {
        const std::lock_guard lock(mutex_);
        is_stopping_ = true;
    }
    changed_.notify_all();
}

/// Throws Stopped.
void Scrub::pause(double seconds) {
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return is_stopping_; }))
        throw Stopped();
}

void Scrub::run() {
    for (;;) try {
            pause(std::min(longest_wait_s, period_s_ / 2));
            check_due();
        } catch (const Stopped&) {
            return;
        } catch (const std::exception& error) {
            spdlog::error("the check of stored bytes: {}", error_text(error));
        }
}

void Scrub::check_due() {
    for (;;) {
        const std::vector<std::string> due = store_.unchecked_since(now() - period_s_, due_at_once);
        for (const std::string& digest : due) check(digest);
        store_.flush_uses();
        if (due.size() < static_cast<std::size_t>(due_at_once)) return;
    }
}

/// A blob that cannot be read now is tried again in the next period.
void Scrub::check(const std::string& digest) {
    try {
        store_.check_digest(
            digest, [&](Sql& sql) { on_loss_(sql, digest); },
            [this](std::size_t bytes) { pause(static_cast<double>(bytes) / bytes_per_second); });
    } catch (const LostBlob& lost) {
        spdlog::error("{}", lost.what());
    } catch (const Refusal& refusal) {
        spdlog::warn("{}", refusal.what());
        store_.note_check_failed(digest);
    }
}

}  // namespace hairbake
