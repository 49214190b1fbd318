#include "server/jobs/local_runner.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "server/store/file_system.h"

namespace hairbake {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;
constexpr std::size_t longest_line = 1 << 20;  // a worker that talks more than that without a line end is not ours

struct Pipe {
    Descriptor read, write;
};

Pipe make_pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw_store_error("pipe", errno);
    return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// The child and its two pipes.
struct Child {
    pid_t id = 0;
    Descriptor input, output;
};

Child start(const WorkerLimits& limits) {
    Pipe input = make_pipe(), output = make_pipe();
    const std::vector<std::string> words{limits.program.string(), "--memory=" + std::to_string(limits.memory_bytes),
                                         "--cpu=" + std::to_string(limits.cpu_seconds),
                                         "--parent=" + std::to_string(::getpid())};
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input.read.get(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output.write.get(), STDOUT_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none, defaults;
    sigemptyset(&none);
    sigfillset(&defaults);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    // A group of its own: Ctrl-C at the terminal is the daemon's to handle.
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    Child child;
    const int error =
        ::posix_spawn(&child.id, limits.program.c_str(), &actions, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (error != 0)
        throw Error(ErrorKind::internal, limits.program.string() + " cannot be started: " + std::strerror(error));
    child.input = std::move(input.write);
    child.output = std::move(output.read);
    return child;
}

/// The task fits into the pipe or the worker reads it; a worker that ended early gives EPIPE, which its end explains.
void send(Child& child, const std::string& text) {
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t count = ::write(child.input.get(), text.data() + sent, text.size() - sent);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) break;
        sent += static_cast<std::size_t>(count);
    }
    child.input = Descriptor();
}

/// Reads a worker's lines and remembers its last word.
class Listener {
public:
    explicit Listener(const Task& task) : task_(task) {}

    /// Returns false when there is no more, or no sense in it.
    bool take(int descriptor) {
        char piece[65536];
        const ssize_t count = ::read(descriptor, piece, sizeof piece);
        if (count < 0 && errno == EINTR) return true;
        if (count <= 0) return false;
        pending_.append(piece, static_cast<std::size_t>(count));
        for (std::size_t end = 0; (end = pending_.find('\n')) != std::string::npos; pending_.erase(0, end + 1))
            line(Json::parse(pending_.substr(0, end), nullptr, false));
        return pending_.size() < longest_line;
    }

    bool has_last_word = false;
    Outcome outcome;

private:
    void line(const Json& words) {
        if (!words.is_object()) return;
        if (words.contains("phase")) {
            const auto fraction = words.find("fraction");
            task_.progress(text(words, "phase"),
                           fraction != words.end() && fraction->is_number() ? fraction->get<double>() : 0);
        } else if (words.contains("done")) {
            has_last_word = true;
            outcome.end = Outcome::End::done;
            outcome.facts = words["done"].dump();
        } else if (words.contains("error") && words["error"].is_object()) {
            has_last_word = true;
            outcome.kind = text(words["error"], "kind");
            outcome.end = outcome.kind == "cancelled" ? Outcome::End::cancelled : Outcome::End::failed;
            outcome.message = text(words["error"], "message");
            outcome.field = text(words["error"], "field");
        }
    }

    /// A worker is not believed to say what it should.
    static std::string text(const Json& object, const char* name) {
        const auto found = object.find(name);
        return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
    }

    const Task& task_;
    std::string pending_;
};

/// Ends a child that shall end: SIGTERM first, SIGKILL two seconds later.
class Stopper {
public:
    Stopper(pid_t child, const Task& task, double wall_seconds)
        : child_(child),
          task_(task),
          deadline_(Clock::now() + std::chrono::milliseconds(std::int64_t(wall_seconds * 1000))) {}

    void look() {
        const auto time = Clock::now();
        if (!asked) {
            const bool cancel = task_.cancel && task_.cancel->load();
            hung = !cancel && time > deadline_;
            if (!cancel && !hung) return;
            asked = true;
            asked_at_ = time;
            ::kill(-child_, SIGTERM);  // its group: what it started, too
        } else if (time - asked_at_ > std::chrono::seconds(2)) {
            ::kill(-child_, SIGKILL);
        }
    }

    bool asked = false, hung = false;

private:
    pid_t child_;
    const Task& task_;
    Clock::time_point deadline_, asked_at_;
};

int wait_for(pid_t child, Stopper& stopper) {
    int status = 0;
    for (int i = 0; ::waitpid(child, &status, WNOHANG) == 0; ++i) {
        stopper.look();
        std::this_thread::sleep_for(std::chrono::milliseconds(i < 20 ? 1 : 20));
    }
    return status;
}

Outcome died(int status, const WorkerLimits& limits) {
    Outcome outcome;
    outcome.kind = "internal";
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
        outcome.end = Outcome::End::failed;
        outcome.kind = "out_of_resources";
        outcome.message = "the worker used more than " + std::to_string(limits.cpu_seconds) + " seconds of CPU time";
    } else if (WIFSIGNALED(status)) {
        outcome.message = std::string("the worker was ended by a signal: ") + ::strsignal(WTERMSIG(status));
    } else {
        outcome.message = "the worker ended with code " + std::to_string(WEXITSTATUS(status)) + " without a result";
    }
    return outcome;
}

}  // namespace

Outcome LocalRunner::run(const Task& task) {
    Child child = start(limits_);
    send(child, task.input);
    Listener listener(task);
    Stopper stopper(child.id, task, limits_.wall_seconds);
    for (bool more = true; more;) {
        stopper.look();
        pollfd ready{child.output.get(), POLLIN, 0};
        if (::poll(&ready, 1, 50) > 0) more = listener.take(child.output.get());
    }
    const int status = wait_for(child.id, stopper);
    if (stopper.hung) {
        Outcome hung;
        hung.end = Outcome::End::failed;
        hung.kind = "out_of_resources";
        hung.message =
            "the worker was not done after " + std::to_string(std::int64_t(limits_.wall_seconds)) + " seconds";
        return hung;
    }
    if (listener.has_last_word && WIFEXITED(status)) return listener.outcome;
    if (stopper.asked) {
        Outcome cancelled;
        cancelled.end = Outcome::End::cancelled;
        return cancelled;
    }
    return died(status, limits_);
}

}  // namespace hairbake
