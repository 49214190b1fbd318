// The pause of the queue while the machine is in trouble: no worker program, a full disk, no processes and so on.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace hairbake {

/// Decides when a stage may be started after the machine made another fail to run. A pause begins with the first
/// trouble. Its waits grow from 1 s to 30 s. After each wait one stage is tried, the *probe*: one that met no trouble
/// where there is one. The pause ends when a probe works; it goes on, with the next wait, when the probe meets a
/// trouble, too. When the probe runs for 10 s without a trouble, another one is started beside it.
///
/// A stage that met a trouble waits itself, in the same steps. When others have worked since, its next trouble is its
/// own and pauses nothing. So stages whose inputs cannot be read do not block all others.
///
/// Not thread-safe. Times are arguments, so that tests need no clock.
class QueuePause {
public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr std::chrono::seconds first_wait{1}, longest_wait{30}, probe_alone{10};

    // ---- before a claim
    /// When a stage may be claimed next: not later than `now` where it is now.
    Time next_try(Time now) const { return reason_.empty() ? now : until_; }
    /// The caller claims a stage now: while the queue is paused, a probe.
    void begin_try(Time now);
    /// Nothing was claimed after begin_try(): the next try may be at `next`.
    void put_off_try(Time next);
    /// The stages that wait themselves, with the ends of their waits.
    const std::map<std::string, Time>& held(Time now);
    /// The first end of their waits; Time::max() when none waits.
    Time first_end(Time now);
    /// Troubles of the stage in a row, 0 for most. While the queue is paused, stages with fewer go first.
    int troubles_of(const std::string& stage) const;
    /// How many stages have troubles in a row.
    std::size_t troubled() const { return waits_.size(); }
    void claimed(const std::string& stage);

    // ---- how a claimed stage ended; stages that are no probes were started before the pause
    /// `reason` is for the operator. An empty `stage`: no stage could be claimed.
    void met_trouble(const std::string& stage, const std::string& reason, Time now);
    /// The stage's worker did its work, or failed by its input.
    void worked(const std::string& stage);
    /// The stage ended and showed nothing about the machine: it was cancelled.
    void ended(const std::string& stage, Time now);
    /// The stage's worker died, and the death counts against the stage: a probe has not worked. The stage waits until
    /// `end`.
    void died(const std::string& stage, const std::string& reason, Time now, Time end);
    /// The stage waits until `end`, for `reason`.
    void hold(const std::string& stage, const std::string& reason, Time end);
    /// The stage does not wait any more.
    void forget(const std::string& stage);
    /// No stage is queued: nothing waits.
    void clear();

    /// Why the queue is paused, or empty.
    const std::string& reason() const { return reason_; }
    /// The last trouble of a stage that has not worked since, or empty.
    std::string reason_of(const std::string& stage) const;
    /// Troubles since the start.
    std::uint64_t troubles() const { return troubles_; }

private:
    struct Wait {
        int troubles = 0;         ///< in a row
        std::uint64_t works = 0;  ///< works_ at the last one
        std::string reason;
    };

    std::string reason_;            ///< empty: not paused
    int failed_tries_ = 0;          ///< in a row
    Time until_{};                  ///< of the next try
    std::set<std::string> probes_;  ///< stages that were claimed during the pause; "" while one is being claimed
    std::uint64_t troubles_ = 0;
    std::uint64_t works_ = 0;            ///< stages that worked
    std::map<std::string, Wait> waits_;  ///< by stage
    std::map<std::string, Time> held_;   ///< the stages of waits_ that may not be claimed yet
};

}  // namespace hairbake
