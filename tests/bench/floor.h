// Lower bounds of this machine, with which the sweep's time is compared.
#pragma once

#include <cstddef>

namespace hairbake::bench {

/// Bytes per second that all cores together read and write in a stream over arrays larger than the caches.
double memory_bandwidth();

/// Seconds that all cores together need for `count` times one gather from a small table, one exp and the four
/// multiply-adds of the sums: the arithmetic that no sweep can leave out, in vectors of this machine.
double arithmetic_time(std::size_t count);

}  // namespace hairbake::bench
