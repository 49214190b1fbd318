// Tells whether the machine is short of something, or a limit of the worker was reached.
#pragma once

#include <cstdint>

namespace hairbake {

/// Whether `bytes` more private memory would exceed the limit RLIMIT_DATA of this process. Allocates nothing.
bool memory_limit_refuses(std::uint64_t bytes);

/// Whether the machine refuses a piece of memory that is small and that the limit allows. Allocates nothing.
bool machine_is_short_of_memory();

/// Whether the machine refuses more threads, for another reason than memory. Libraries do not tell why they failed.
bool machine_is_short_of_threads();

}  // namespace hairbake
