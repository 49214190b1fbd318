// Parallel loops. hairbake uses threads in no other way; TBB runs them.
#pragma once

#include <cstddef>
#include <functional>

namespace hairbake {

/// Runs `body(begin, end)` over disjoint pieces of [0, count), each of at most `grain` items, on all threads of the
/// surrounding with_threads(). The pieces depend on count and grain alone, so a body that writes per piece gives the
/// same bytes for any number of threads. The first exception is rethrown.
void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

/// Runs `body` with `threads` threads for every parallel_for inside it (0: one per core).
void with_threads(int threads, const std::function<void()>& body);

/// Number of threads that parallel_for uses here.
int thread_count();

/// Index of the calling thread, in [0, thread_count()), inside parallel_for.
int thread_index();

}  // namespace hairbake
