// Runs each worker as a child process of the daemon. A stopped or hung worker gets SIGTERM and, two seconds later,
// SIGKILL. The kernel kills all of them when the daemon ends.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <vector>

#include "core/base/error.h"
#include "server/jobs/runner.h"
#include "server/store/store_advice.h"

namespace hairbake {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using State = RunStatus::State;
constexpr std::chrono::seconds time_to_stop{2};  // between SIGTERM and SIGKILL

/// How a child starts: no signal blocked or ignored, a process group of its own (Ctrl-C at the terminal is the daemon's
/// to handle), and nothing on its standard input and output.
class SpawnSettings {
public:
    SpawnSettings() {
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        posix_spawnattr_init(&attributes);
        sigset_t none, all;
        sigemptyset(&none);
        sigfillset(&all);
        posix_spawnattr_setsigmask(&attributes, &none);
        posix_spawnattr_setsigdefault(&attributes, &all);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    }
    ~SpawnSettings() {
        posix_spawn_file_actions_destroy(&actions);
        posix_spawnattr_destroy(&attributes);
    }
    SpawnSettings(const SpawnSettings&) = delete;
    SpawnSettings& operator=(const SpawnSettings&) = delete;

    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
};

/// `error` is errno of a start of the program.
std::string advice_to_start(const fs::path& program, int error) {
    std::error_code unknown;
    switch (error) {
        case ENOENT:
            if (fs::exists(program, unknown))
                return "The file is there, and the interpreter that it names is missing: `file` shows its name. "
                       "Install it, or install hairbake again";
            return "Install hairbake again, or let [workers] program name the file";
        case EAGAIN:
            return "The system gives user " + std::to_string(::geteuid()) +
                   " no more processes: end some, raise the limit (`ulimit -u`, TasksMax of the unit, pids of the "
                   "container), or lower [workers] count";
        case ENOMEM:
            return "The machine is short of memory: end other programs, or lower [workers] count";
        case EACCES:
            return "User " + std::to_string(::geteuid()) + " may not run it: `chmod a+rx " + program.string() +
                   "`, and the folders above must be searchable";
        case ENOEXEC:
            return "The file is damaged or of another kind of machine: install hairbake again";
        default:
            return advice_for(program, error);
    }
}

/// `error` is errno.
[[noreturn]] void refuse_to_start(const fs::path& program, int error) {
    throw Error(ErrorKind::internal,
                "the worker program " + program.string() + " cannot be started: " +
                    std::generic_category().message(error) + ". " + advice_to_start(program, error),
                {}, error);
}

pid_t spawn(const RunnerSettings& settings, const fs::path& work_folder) {
    std::vector<std::string> words{settings.program.string(), "--memory=" + std::to_string(settings.memory_bytes),
                                   "--cpu=" + std::to_string(settings.cpu_seconds),
                                   "--parent=" + std::to_string(::getpid()), work_folder.string()};
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const SpawnSettings spawn;
    pid_t child = 0;
    const int error =
        ::posix_spawn(&child, settings.program.c_str(), &spawn.actions, &spawn.attributes, arguments.data(), environ);
    if (error != 0) refuse_to_start(settings.program, error);
    return child;
}

struct Child {
    Clock::time_point deadline;
    std::optional<Clock::time_point> asked_to_stop;
    bool is_hung = false;
};

class LocalRunner : public Runner {
public:
    explicit LocalRunner(const RunnerSettings& settings) : settings_(settings) {}

    std::string start(const fs::path& work_folder) override {
        const pid_t child = spawn(settings_, work_folder);
        const auto wall = std::chrono::milliseconds(static_cast<std::int64_t>(settings_.wall_seconds * 1000));
        const std::lock_guard lock(mutex_);
        children_[child] = {Clock::now() + wall, std::nullopt, false};
        return std::to_string(child);
    }

    RunStatus poll(const std::string& handle) override {
        const std::lock_guard lock(mutex_);
        const auto found = find(handle);
        if (found == children_.end()) return {State::killed, "the worker " + handle + " is unknown", true};
        const pid_t child = found->first;
        siginfo_t end{};
        if (::waitid(P_PID, static_cast<id_t>(child), &end, WEXITED | WNOHANG | WNOWAIT) == 0 && end.si_pid == 0) {
            enforce_limits(child, found->second);
            return {};
        }
        ::kill(-child, SIGKILL);  // processes that the worker left behind; its id is not free before waitpid()
        int status = 0;
        ::waitpid(child, &status, 0);
        const bool is_hung = found->second.is_hung;
        children_.erase(found);
        return is_hung
                   ? RunStatus{State::over_limit, "the worker was not done after " +
                                                      std::to_string(std::int64_t(settings_.wall_seconds)) + " seconds"}
                   : ended(status);
    }

    void stop(const std::string& handle) override {
        const std::lock_guard lock(mutex_);
        if (const auto found = find(handle); found != children_.end() && !found->second.asked_to_stop)
            ask_to_stop(found->first, found->second);
    }

    void check_ready() override {
        if (::access(settings_.program.c_str(), X_OK) != 0) refuse_to_start(settings_.program, errno);
    }

    std::string program() const override { return settings_.program.string(); }

    bool survives_restart() const override { return false; }

private:
    using Children = std::map<pid_t, Child>;

    Children::iterator find(const std::string& handle) {
        return children_.find(static_cast<pid_t>(std::strtol(handle.c_str(), nullptr, 10)));
    }

    static void ask_to_stop(pid_t child, Child& facts) {
        facts.asked_to_stop = Clock::now();
        ::kill(-child, SIGTERM);  // the whole group: what the worker started, too
    }

    static void enforce_limits(pid_t child, Child& facts) {
        const auto time = Clock::now();
        if (facts.asked_to_stop) {
            if (time - *facts.asked_to_stop > time_to_stop) ::kill(-child, SIGKILL);
        } else if (time > facts.deadline) {
            facts.is_hung = true;
            ask_to_stop(child, facts);
        }
    }

    RunStatus ended(int status) const {
        if (!WIFSIGNALED(status))
            return {State::exited, "the worker ended with code " + std::to_string(WEXITSTATUS(status))};
        if (WTERMSIG(status) == SIGXCPU)
            return {State::over_limit,
                    "the worker used more than " + std::to_string(settings_.cpu_seconds) + " seconds of CPU time"};
        const int signal = WTERMSIG(status);
        const char* const name = ::sigabbrev_np(signal);
        return {State::killed,
                std::string("the worker was ended by a signal: ") + ::strsignal(signal) +
                    (name ? std::string(" (SIG") + name + ")" : std::string()),
                signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP || signal == SIGQUIT};
    }

    const RunnerSettings settings_;
    std::mutex mutex_;
    Children children_;
};

}  // namespace

std::unique_ptr<Runner> make_local_runner(const RunnerSettings& settings) {
    return std::make_unique<LocalRunner>(settings);
}

}  // namespace hairbake
