// How long bodies under way take, to tell a refused client when a place may be free.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace hairbake {

/// Thread-safe. Times are arguments, so that tests need no clock.
class PlaceTimes {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr int longest_s = 60;

    /// Its destructor notes the end of the body. The PlaceTimes outlive it.
    class Begun {
    public:
        ~Begun();
        Begun(Begun&& other) noexcept;
        Begun& operator=(Begun&&) = delete;

    private:
        friend class PlaceTimes;
        Begun(PlaceTimes& times, std::uint64_t number) : times_(&times), number_(number) {}

        PlaceTimes* times_;
        std::uint64_t number_;
    };

    /// A body of `address` was let in.
    Begun begin(const std::string& address) { return begin(address, Clock::now()); }
    Begun begin(const std::string& address, Clock::time_point now);

    /// The mean time, in seconds from 1 to longest_s, until one of the bodies of this address ends; of all bodies where
    /// it has none. A body takes as long as the last ones did, and not less than those under way have taken already; n
    /// such bodies that began at any time end on average at the n + 1 parts of that time.
    int seconds_until_one_ends(const std::string& address, Clock::time_point now);

private:
    struct Body {
        std::string address;
        Clock::time_point begin;
    };
    void end(std::uint64_t number, Clock::time_point now);

    std::mutex mutex_;  ///< guards the members below
    std::uint64_t next_number_ = 0;
    std::map<std::uint64_t, Body> bodies_;
    double usual_s_ = 0;  ///< of the last bodies that ended: a mean in which each has the weight 1/8
    bool has_usual_ = false;
};

}  // namespace hairbake
