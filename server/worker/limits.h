// What a worker may take, set by itself before it reads a byte.
#pragma once

#include <sys/types.h>

#include <cstdint>

namespace hairbake {

struct Limits {
    std::uint64_t memory_bytes = 0;  ///< of private memory (RLIMIT_DATA); 0: none
    std::uint64_t cpu_seconds = 0;   ///< of all threads (RLIMIT_CPU); 0: none
    pid_t parent = 0;                ///< the daemon: when it ends, the kernel ends this process; 0: nobody
};

/// Throws Error(internal) when a limit cannot be set, or the parent is gone already.
void apply(const Limits& limits);

/// From now on the end of memory, in whatever thread, is a last word on standard output (task.h) instead of an abort.
void report_memory_exhaustion();

}  // namespace hairbake
