// hairbake-worker: runs one task of the service in a process of its own. See task.h for what it reads and writes.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>

#include "core/base/error_kind_names.h"
#include "core/base/json_reason.h"
#include "server/worker/limits.h"
#include "server/worker/shortage.h"
#include "server/worker/task.h"

namespace {

using hairbake::Error;
using hairbake::ErrorKind;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;
constexpr std::uint64_t largest_stack = 16 << 20;  // of a thread, which is usually 8 MiB

/// A full disk does not end the task; the daemon reserved space for the last word.
void say(const Json& words) {
    const std::string line = words.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    for (std::size_t written = 0; written < line.size();) {
        const ssize_t count = ::write(STDOUT_FILENO, line.data() + written, line.size() - written);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return;
        written += static_cast<std::size_t>(count);
    }
}

/// Everything that is written to standard output from now on is appended to `words`.
void redirect_output(const fs::path& words) {
    const int descriptor = ::open(words.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0640);
    if (descriptor < 0 || ::dup2(descriptor, STDOUT_FILENO) < 0)
        throw Error(ErrorKind::internal, words.string() + " cannot be written", {}, errno);
    ::close(descriptor);
}

/// Throws Error with the system's error number.
std::string read_file(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    if (!(text << stream.rdbuf()))
        throw Error(ErrorKind::internal, file.string() + " cannot be read", {}, errno != 0 ? errno : EIO);
    return text.str();
}

/// Progress as lines, at most twenty a second and a few hundred a phase: words.jsonl stays small.
class LineProgress : public hairbake::BakeProgress {
public:
    void enter(std::string_view phase) override {
        {
            const std::lock_guard lock(mutex_);
            phase_ = phase;
            is_new_phase_ = true;
        }
        report(0);
    }

    void report(double fraction) override {
        const std::lock_guard lock(mutex_);
        const auto time = std::chrono::steady_clock::now();
        const bool is_news = time - said_at_ >= std::chrono::milliseconds(50) && fraction >= said_ + 0.002;
        if (!is_new_phase_ && fraction < 1 && !is_news) return;
        is_new_phase_ = false;
        said_ = fraction;
        said_at_ = time;
        say({{"phase", phase_}, {"fraction", fraction}});
    }

private:
    std::mutex mutex_;
    std::string phase_;
    bool is_new_phase_ = true;
    double said_ = 0;  ///< the fraction
    std::chrono::steady_clock::time_point said_at_;
};

/// SIGTERM cancels the task; the daemon sends SIGKILL to a worker that does not stop.
std::jthread watch_for_stop(hairbake::Progress& progress) {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    return std::jthread([set, &progress](const std::stop_token& stop) {
        const timespec patience{0, 50'000'000};
        while (!stop.stop_requested())
            if (sigtimedwait(&set, nullptr, &patience) > 0) progress.cancel();
    });
}

/// Whether the machine is at fault, and not the input or the request. Libraries name no number of the system's when
/// they cannot start a thread; their messages make an internal error or seem to be about the file.
bool is_of_machine(const Error& error) {
    if (error.system_error() == ENOMEM && hairbake::memory_limit_refuses(largest_stack)) return false;
    if (error.system_error() != 0) return true;
    const bool may_be = error.kind() == ErrorKind::internal || error.kind() == ErrorKind::bad_input;
    return may_be && hairbake::machine_is_short_of_threads();
}

/// What to do about an error of the system's that a person can mend; empty for all others.
std::string remedy_for(int error) {
    if (error == EFBIG)
        return ". A limit of the size of files holds for this process (`ulimit -f`, LimitFSIZE= of its unit), or the "
               "file system has one: raise it";
    if (error == ENOSPC || error == EDQUOT) return ". Make room on the disk of the store";
    return {};
}

int fail(const Error& error, const std::string& task, const fs::path& folder) {
    say({{"error",
          {{"kind", hairbake::name_of(error.kind())},
           {"message", hairbake::with_names(error.what(), task, folder) + remedy_for(error.system_error())},
           {"field", error.field()},
           {"machine", is_of_machine(error)}}}});
    return 1;
}

/// An error of std::filesystem, or no thread can be started: by the limit of memory, for the thread's stack, or because
/// the machine has no more.
Error error_of(const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again && hairbake::memory_limit_refuses(largest_stack))
        return Error(ErrorKind::out_of_resources, "the worker's memory limit was reached");
    const auto* const of_file = dynamic_cast<const fs::filesystem_error*>(&error);
    const std::string found = of_file ? of_file->path1().string() + ": " + error.code().message() : error.what();
    return Error(ErrorKind::out_of_resources, found, {}, error.code().value());
}

int work(const std::string& task, const fs::path& folder, hairbake::BakeProgress& progress) {
    try {
        say({{"begin", Json::object()}});
        const std::string done = hairbake::run_task(task, folder, progress);
        say({{"done", Json::parse(done)}});
        return 0;
    } catch (const Error& error) {
        return fail(error, task, folder);
    } catch (const std::system_error& error) {
        return fail(error_of(error), task, folder);
    } catch (const std::bad_alloc&) {
        return fail(Error(ErrorKind::out_of_resources, "the worker's memory limit was reached"), task, folder);
    } catch (const std::exception& error) {
        return fail(Error(ErrorKind::internal, hairbake::json_reason(error)), task, folder);
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Runs one task of hairbaked: reads FOLDER/task.json, writes FOLDER/words.jsonl and the result."};
    hairbake::Limits limits;
    fs::path folder;
    app.add_option("--memory", limits.memory_bytes, "limit of private memory in bytes; 0: no limit");
    app.add_option("--cpu", limits.cpu_seconds, "limit of CPU time in seconds; 0: no limit");
    app.add_option("--parent", limits.parent, "the kernel kills the worker when this process ends; 0: no process");
    app.add_option("FOLDER", folder, "work folder")->required();
    CLI11_PARSE(app, argc, argv);
    LineProgress progress;
    try {
        redirect_output(folder / "words.jsonl");
        hairbake::report_memory_exhaustion();
        apply(limits);
        const std::jthread watch = watch_for_stop(progress);
        _exit(work(read_file(folder / "task.json"), folder,
                   progress));  // without the destructors of libraries: everything is written
    } catch (const Error& error) {
        return fail(error, "", folder);
    } catch (const std::system_error& error) {
        return fail(error_of(error), "", folder);
    }
}
