#include "server/jobs/queue_pause.h"

#include <algorithm>

namespace hairbake {
namespace {

/// The wait after so many troubles in a row, from 1.
std::chrono::seconds wait_after(int troubles) {
    const int doublings = std::min(troubles - 1, 10);
    return std::min(QueuePause::longest_wait, QueuePause::first_wait * (1 << doublings));
}

}  // namespace

void QueuePause::begin_try(Time now) {
    if (reason_.empty()) return;
    until_ = now + probe_alone;
    probes_.insert("");
}

void QueuePause::put_off_try(Time next) {
    until_ = next;
    probes_.erase("");
}

const std::map<std::string, QueuePause::Time>& QueuePause::held(Time now) {
    std::erase_if(held_, [&](const auto& entry) { return entry.second <= now; });
    return held_;
}

QueuePause::Time QueuePause::first_end(Time now) {
    Time first = Time::max();
    for (const auto& [stage, end] : held(now)) first = std::min(first, end);
    return first;
}

int QueuePause::troubles_of(const std::string& stage) const {
    const auto wait = waits_.find(stage);
    return wait == waits_.end() ? 0 : wait->second.troubles;
}

void QueuePause::claimed(const std::string& stage) {
    if (probes_.erase("")) probes_.insert(stage);
}

void QueuePause::met_trouble(const std::string& stage, const std::string& reason, Time now) {
    ++troubles_;
    bool is_own = false;
    if (!stage.empty()) {
        const Wait& wait = waits_[stage];
        is_own = wait.troubles > 0 && works_ > wait.works;
        hold(stage, reason, now + wait_after(wait.troubles + 1));
    }
    const bool is_first = reason_.empty(), is_probe = probes_.erase(stage) > 0;
    if (is_first && is_own) return;
    reason_ = reason;
    if (is_first || is_probe) until_ = now + wait_after(++failed_tries_);
}

void QueuePause::worked(const std::string& stage) {
    ++works_;
    forget(stage);
    if (probes_.count(stage)) clear();
}

void QueuePause::ended(const std::string& stage, Time now) {
    forget(stage);
    if (probes_.erase(stage)) until_ = now;
}

void QueuePause::died(const std::string& stage, const std::string& reason, Time now, Time end) {
    if (probes_.erase(stage)) until_ = now + wait_after(++failed_tries_);
    hold(stage, reason, end);
}

void QueuePause::hold(const std::string& stage, const std::string& reason, Time end) {
    Wait& wait = waits_[stage];
    ++wait.troubles;
    wait.works = works_;
    wait.reason = reason;
    held_[stage] = end;
}

void QueuePause::forget(const std::string& stage) {
    waits_.erase(stage);
    held_.erase(stage);
}

void QueuePause::clear() {
    reason_.clear();
    failed_tries_ = 0;
    probes_.clear();
}

std::string QueuePause::reason_of(const std::string& stage) const {
    const auto wait = waits_.find(stage);
    return wait == waits_.end() ? std::string() : wait->second.reason;
}

}  // namespace hairbake
