// The worker slots: threads that take stages from the queue, have them run, and store what came of them.
#pragma once

#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include "server/jobs/queue.h"
#include "server/jobs/runner.h"
#include "server/jobs/work_folder.h"

namespace hairbake {

class Slots {
public:
    /// `budget` of the store in bytes; `threads` for each worker.
    Slots(Queue& queue, Runner& runner, Database& database, BlobStore& store, std::uint64_t budget, int slots,
          int threads);
    /// Queue::stop() comes first.
    ~Slots();

private:
    void work();
    void run_to_the_end(const ClaimedStage& stage);
    void run(const ClaimedStage& stage);
    std::string task_for(const ClaimedStage& stage, const std::filesystem::path& folder);
    void remove_spoiled_inputs(const std::vector<std::string>& digests);
    void store_result(const ClaimedStage& stage, std::optional<WorkFolder>& work);

    Queue& queue_;
    Runner& runner_;
    Database& database_;
    BlobStore& store_;
    std::uint64_t budget_;
    int threads_;
    std::vector<std::jthread> slots_;
};

}  // namespace hairbake
