// A seeded generator whose numbers are the same on every machine and with every standard library.
#pragma once

#include <cstdint>

namespace hairbake {

/// SplitMix64 (Steele, Lea and Flood 2014): the state advances by the golden ratio and is mixed. Not for secrets.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next_u64() {
        std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return z ^ (z >> 31);
    }
    /// Uniform in [0, 1).
    double next() { return static_cast<double>(next_u64() >> 11) * 0x1p-53; }
    /// Uniform in [low, high).
    double next(double low, double high) { return low + (high - low) * next(); }

private:
    std::uint64_t state_;
};

}  // namespace hairbake
