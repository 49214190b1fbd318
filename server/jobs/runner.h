// The interface of everything that can run hairbake-worker: child processes here, a queue of a render farm elsewhere.
//
// A runner only starts, watches and stops. The worker reads its task from a work folder and writes its words and its
// result there (work_folder.h), so a runner needs no channel to it. To add a runner, write NAME_runner.cpp with a
// function that makes it, list the file in CMakeLists.txt, and add a line to the table in runner_kinds.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace hairbake {

/// The [workers] settings that a runner enforces.
struct RunnerSettings {
    std::filesystem::path program;            ///< hairbake-worker
    std::uint64_t memory_bytes = 8ull << 30;  ///< limit of private memory of a worker; 0: no limit
    std::uint64_t cpu_seconds = 4 * 3600;     ///< limit of CPU time, all threads of a worker together; 0: no limit
    double wall_seconds = 2 * 3600;           ///< limit of the time from start to end
};

/// What a runner knows about a task. The worker's own words stand in the work folder.
struct RunStatus {
    enum class State {
        running,
        exited,     ///< the worker ended by itself: its last word counts
        killed,     ///< the worker crashed, was killed, or was lost; another attempt may succeed
        over_limit  ///< the worker reached a limit of RunnerSettings; another attempt would, too
    };
    State state = State::running;
    std::string message;  ///< how the worker ended, for people; empty while it runs
    /// Of `killed`: the system, another process or a lost connection ended it, and no fault of its own such as a wrong
    /// address.
    bool from_outside = false;
};

/// Thread-safe.
class Runner {
public:
    virtual ~Runner() = default;

    /// Starts hairbake-worker on a work folder and returns a handle, a short text that names the run.
    /// Throws Error when the worker cannot be started now: the machine is at fault, and never the task.
    virtual std::string start(const std::filesystem::path& work_folder) = 0;

    /// Never blocks for long. The handle of an ended worker is forgotten once its end was returned; an unknown handle
    /// is `killed`. Limits and stop() may be enforced here, so callers poll until the end.
    virtual RunStatus poll(const std::string& handle) = 0;

    /// Asks the worker to stop and returns at once. A worker that does not stop is killed some seconds later.
    virtual void stop(const std::string& handle) = 0;

    /// What it starts, for messages.
    virtual std::string program() const { return "hairbake-worker"; }

    /// Throws Error, saying why, when no task can be started at present.
    virtual void check_ready() = 0;

    /// Whether workers go on without the daemon, and handles stay valid for the next daemon. Then the daemon stores the
    /// handle with its stage, leaves the worker alone when it stops, and follows it again when it starts.
    virtual bool survives_restart() const = 0;
};

}  // namespace hairbake
