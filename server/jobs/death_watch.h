// Tells workers that the machine ended from workers that die by their input: by the company that they have.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hairbake {

/// For deaths from outside alone (SIGKILL of a system without memory, and the like). The machine is at fault when
/// workers of different stages were ended and no stage that was started since has worked. One stage whose workers are
/// ended while others work has itself to blame: it probably needs too much memory. So has a stage whose deaths were
/// forgiven for longer than the patience.
///
/// Not thread-safe. Times are arguments, so that tests need no clock.
class DeathWatch {
public:
    using Time = std::chrono::steady_clock::time_point;
    using Duration = std::chrono::steady_clock::duration;

    /// Deaths further apart than `patience` are not of one trouble. 0: the machine is never at fault.
    explicit DeathWatch(Duration patience) : patience_(patience) {}

    /// A worker of the stage starts.
    void started(const std::string& stage);

    /// An earlier stage whose deaths are forgiven, too.
    struct Forgiven {
        std::string stage;
        int deaths = 0;  ///< the last ones
    };
    struct Verdict {
        bool is_of_machine = false;  ///< else the death counts
        std::size_t stages = 0;      ///< of the machine: so many stages have died, this one included
        std::vector<Forgiven> also;
    };
    Verdict died(const std::string& stage, Time now);

    /// The stage's worker did its work, or failed by its input.
    void worked(const std::string& stage);
    /// The stage was cancelled, or has failed by its deaths.
    void forget(const std::string& stage);

private:
    struct Deaths {
        Time last{};
        std::uint64_t tick = 0;              ///< of the last one
        bool others_worked = false;          ///< a stage that was started after it
        bool is_own = false;                 ///< others had worked before it: shows nothing about the machine
        int counted = 0;                     ///< in a row, since others have worked
        std::optional<Time> forgiven_since;  ///< in a row
    };
    bool is_sign(const Deaths& deaths, Time now) const;

    Duration patience_;
    std::uint64_t tick_ = 0;                       ///< grows with each start and death
    std::map<std::string, std::uint64_t> starts_;  ///< the ticks of stages that run
    std::map<std::string, Deaths> deaths_;         ///< by stage
};

}  // namespace hairbake
