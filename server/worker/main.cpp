// hairbake-worker: runs one task of the service in a process of its own. See task.h for what it reads and writes.
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <iterator>
#include <mutex>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <thread>

#include "server/worker/limits.h"
#include "server/worker/task.h"

namespace {

using hairbake::Error;
using hairbake::ErrorKind;
using Json = nlohmann::ordered_json;

void say(const Json& line) { std::cout << line.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl; }

/// Progress as lines, at most twenty a second.
class LineProgress : public hairbake::BakeProgress {
public:
    void enter(std::string_view phase) override {
        {
            const std::lock_guard lock(mutex_);
            phase_ = phase;
            said_ = {};
        }
        report(0);
    }

    void report(double fraction) override {
        const std::lock_guard lock(mutex_);
        const auto time = std::chrono::steady_clock::now();
        if (fraction < 1 && time - said_ < std::chrono::milliseconds(50)) return;
        said_ = time;
        say({{"phase", phase_}, {"fraction", fraction}});
    }

private:
    std::mutex mutex_;
    std::string phase_;
    std::chrono::steady_clock::time_point said_;
};

/// SIGTERM asks the task to stop; the daemon sends SIGKILL to what does not listen.
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

const char* name_of(ErrorKind kind) {
    switch (kind) {
        case ErrorKind::usage:
            return "usage";
        case ErrorKind::bad_input:
            return "bad_input";
        case ErrorKind::out_of_resources:
            return "out_of_resources";
        case ErrorKind::cancelled:
            return "cancelled";
        default:
            return "internal";
    }
}

int fail(const Error& error, const std::string& task) {
    say({{"error",
          {{"kind", name_of(error.kind())},
           {"message", hairbake::with_names(error.what(), task)},
           {"field", error.field()}}}});
    return 1;
}

int work(hairbake::BakeProgress& progress) {
    const std::string task{std::istreambuf_iterator<char>(std::cin), {}};
    try {
        const std::string done = hairbake::run_task(task, progress);
        say({{"done", Json::parse(done)}});
        return 0;
    } catch (const Error& error) {
        return fail(error, task);
    } catch (const std::bad_alloc&) {
        return fail(Error(ErrorKind::out_of_resources, "the worker's memory limit was reached"), task);
    } catch (const std::exception& error) {
        return fail(Error(ErrorKind::internal, error.what()), task);
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Runs one task of hairbaked: JSON on standard input, JSON lines on standard output."};
    hairbake::Limits limits;
    app.add_option("--memory", limits.memory_bytes, "limit of private memory in bytes; 0: none");
    app.add_option("--cpu", limits.cpu_seconds, "limit of CPU time in seconds; 0: none");
    app.add_option("--parent", limits.parent, "process whose end ends this one");
    CLI11_PARSE(app, argc, argv);
    LineProgress progress;
    try {
        hairbake::report_memory_exhaustion();
        apply(limits);
        const std::jthread watch = watch_for_stop(progress);
        const int code = work(progress);
        std::cout.flush();
        _exit(code);  // without destructors of libraries: everything is written
    } catch (const Error& error) {
        return fail(error, "");
    }
}
