// The worker pool: threads that take stages from the queue, have them run, and store their results.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/bake_records.h"

namespace hairbake {

class BlobStore;
class Database;
class Queue;
class Room;
class Runner;
class WorkFolder;
struct ClaimedStage;
struct Outcome;
struct StageFile;

struct WorkerPoolSettings {
    std::string runner;  ///< name of the runner, stored with its handles
    int workers = 1;     ///< at once
    int threads = 1;     ///< of each worker
};

class WorkerPool {
public:
    WorkerPool(Queue& queue, Runner& runner, Database& database, BlobStore& store, Room& room,
               const WorkerPoolSettings& settings);
    /// Queue::stop() comes first.
    ~WorkerPool();

private:
    void work();
    void run_to_the_end(const ClaimedStage& stage);
    Outcome run(const ClaimedStage& stage);
    void record(const ClaimedStage& stage, const Outcome& outcome);
    Outcome run_worker(const ClaimedStage& stage, WorkFolder& folder);
    std::string start(const ClaimedStage& stage, const WorkFolder& folder);
    static std::vector<std::string> input_digests(const ClaimedStage& stage);
    std::string task_for(const ClaimedStage& stage);
    void note_leftover(const std::filesystem::path& folder);
    void remove_leftovers();
    // worker_pool_results.cpp
    void remove_spoiled_inputs(const std::vector<std::string>& digests);
    std::string checked_manifest(const ClaimedStage& stage, const std::filesystem::path& folder);
    using Sizes = std::map<std::string, std::uint64_t>;  ///< of files, in bytes, by digest: equal files are one blob
    /// What is known of a result that found no room.
    struct Waiting {
        Sizes sizes;                             ///< the budget had no room; empty: the disk had none
        std::optional<std::uint64_t> disk_free;  ///< bytes, when the disk had no room
    };
    void check_fits(const ClaimedStage& stage, const Sizes& sizes);
    std::uint64_t new_bytes(const Sizes& sizes);
    std::uint64_t bytes_beside(const ClaimedStage& stage, const Sizes& sizes, std::uint64_t enough);
    void check_known_result(const ClaimedStage& stage);
    void require_room(const ClaimedStage& stage, std::uint64_t bytes);
    void make_room(const ClaimedStage& stage, const Sizes& sizes);
    void note_full_disk(const ClaimedStage& stage);
    void remember(const ClaimedStage& stage, Waiting waiting);
    void forget_result(const ClaimedStage& stage);
    void store_result(const ClaimedStage& stage, std::unique_ptr<WorkFolder> work);

    Queue& queue_;
    Runner& runner_;
    Database& database_;
    BlobStore& store_;
    Room& room_;
    const WorkerPoolSettings settings_;
    std::mutex mutex_;
    std::vector<std::filesystem::path> leftovers_;  ///< work folders that could not be removed; guarded by mutex_
    std::map<std::string, Waiting> waiting_;        ///< by stage; guarded by mutex_
    std::vector<std::jthread> threads_;
};

}  // namespace hairbake
