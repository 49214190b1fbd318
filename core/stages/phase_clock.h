// Runs the phases of a bake: reports their names to the progress and measures their time.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <string_view>

#include "core/base/progress.h"

namespace hairbake {

/// Not thread-safe: phases follow each other.
class PhaseClock {
public:
    /// Adds wall seconds to `timings_s`, which must outlive this object, as must `progress`.
    PhaseClock(BakeProgress& progress, std::map<std::string, double>& timings_s)
        : progress_(progress), timings_s_(timings_s) {}

    /// Runs `body` with a Progress that goes from 0 to 1.
    /// Throws Error(cancelled) before it begins, and what `body` throws.
    template <class Body>
    void run(std::string_view phase, const Body& body) {
        progress_.check();
        progress_.enter(phase);
        const auto start = std::chrono::steady_clock::now();
        body(static_cast<Progress&>(progress_));
        timings_s_[std::string(phase)] +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        progress_.report(1);
    }

private:
    BakeProgress& progress_;
    std::map<std::string, double>& timings_s_;
};

}  // namespace hairbake
