// How a task is run: as a local process today, by a farm's engine tomorrow.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace hairbake {

/// A task for hairbake-worker; its words are described in server/worker/task.h.
struct Task {
    std::string input;                                      ///< JSON for the worker's standard input
    std::function<void(std::string_view, double)> progress  ///< phase and its fraction; from the calling thread
        = [](std::string_view, double) {};
    const std::atomic<bool>* cancel = nullptr;  ///< when it becomes true, the task is stopped
};

struct Outcome {
    enum class End {
        done,       ///< `facts` holds the worker's last word
        failed,     ///< `kind`, `message`, `field` hold it; running it again would fail again
        died,       ///< no last word: killed or crashed; `message` tells how
        cancelled,  ///< because *cancel was set
    };
    End end = End::died;
    std::string facts = "{}";
    std::string kind, message, field;
};

class Runner {
public:
    virtual ~Runner() = default;
    /// Blocks until the task has ended. Thread-safe. Throws nothing but what the system runs out of.
    virtual Outcome run(const Task& task) = 0;
};

}  // namespace hairbake
