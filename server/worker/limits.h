// Resource limits of a worker. It sets them itself before it reads its task.
#pragma once

#include <sys/types.h>

#include <cstdint>

namespace hairbake {

struct Limits {
    std::uint64_t memory_bytes = 0;  ///< private memory (RLIMIT_DATA); 0: no limit
    std::uint64_t cpu_seconds = 0;   ///< CPU time of all threads (RLIMIT_CPU); 0: no limit
    pid_t parent = 0;                ///< the kernel kills this process when that one ends; 0: no such process
};

/// Throws Error(internal), with the system's error number, when a limit cannot be set.
/// Throws Error(cancelled) when the parent is gone already.
void apply(const Limits& limits);

/// From now on a worker that runs out of memory, in any thread, writes a last word (task.h) to standard output and ends
/// with code 4 instead of aborting. The word tells whether the limit was reached or the machine is short of memory or
/// processes.
void report_memory_exhaustion();

}  // namespace hairbake
