#include "core/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace hairbake {

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
    if (count == 0) return;
    grain = std::max<std::size_t>(1, grain);
    const std::size_t pieces = (count + grain - 1) / grain;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, pieces, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t piece = range.begin(); piece != range.end(); ++piece)
                body(piece * grain, std::min(count, (piece + 1) * grain));
        },
        tbb::simple_partitioner());
}

void with_threads(int threads, const std::function<void()>& body) {
    const int wanted = threads > 0 ? threads : tbb::this_task_arena::max_concurrency();
    // An arena alone is limited to the number of cores. The control lifts that limit, so that tests can run seven
    // threads on two cores.
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(wanted));
    tbb::task_arena arena(wanted);
    arena.execute(body);
}

int thread_count() { return tbb::this_task_arena::max_concurrency(); }

int thread_index() { return tbb::this_task_arena::current_thread_index(); }

}  // namespace hairbake
