// Runs each task in a child process of the daemon.
#pragma once

#include <cstdint>
#include <filesystem>

#include "server/jobs/runner.h"

namespace hairbake {

struct WorkerLimits {
    std::filesystem::path program;            ///< hairbake-worker
    std::uint64_t memory_bytes = 4ull << 30;  ///< private memory; 0: no limit
    std::uint64_t cpu_seconds = 3600;         ///< of all threads together; 0: no limit
    double wall_seconds = 3600;               ///< then it counts as hung
};

/// A cancelled or hung child gets SIGTERM and, two seconds later, SIGKILL. A child dies with the daemon.
class LocalRunner : public Runner {
public:
    explicit LocalRunner(WorkerLimits limits) : limits_(std::move(limits)) {}
    Outcome run(const Task& task) override;

private:
    WorkerLimits limits_;
};

}  // namespace hairbake
