// The least rate at which a body must arrive.
#pragma once

#include <chrono>
#include <cstdint>

namespace hairbake {

/// For one body, and one thread. Only time in which the daemon waits for the client counts: a slow disk is not the
/// client's fault. The time is cut into windows; in each, the body must bring its bytes.
class BodyPace {
public:
    struct Limits {
        std::uint64_t bytes_per_second = 0;   ///< 0: any rate
        std::chrono::milliseconds window{0};  ///< over which the rate is averaged
    };

    explicit BodyPace(const Limits& limits) : limits_(limits) {}

    const Limits& limits() const { return limits_; }

    /// The daemon waited for the client, and then `bytes` came. Returns false when a window is over and had too few.
    bool add(std::uint64_t bytes, std::chrono::nanoseconds waited);

private:
    const Limits limits_;
    std::uint64_t bytes_ = 0;            ///< in this window
    std::chrono::nanoseconds waited_{};  ///< in this window
};

}  // namespace hairbake
