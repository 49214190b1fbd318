#include "server/worker/limits.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <new>
#include <system_error>

#include "core/base/error.h"

namespace hairbake {
namespace {

/// The hard limit is `grace` above the soft one. For CPU time the soft limit sends SIGXCPU, by which the daemon knows
/// the reason, and the hard limit sends SIGKILL.
void set_limit(__rlimit_resource resource, std::uint64_t value, std::uint64_t grace = 0) {
    if (value == 0) return;
    const rlimit limit{value, value + grace};
    if (::setrlimit(resource, &limit) != 0) throw Error(ErrorKind::internal, "a limit of the worker cannot be set");
}

void say_out_of_memory() {
    static constexpr char words[] =
        "\n{\"error\":{\"kind\":\"out_of_resources\",\"message\":\"the worker's memory limit was reached; fewer "
        "voxels, vertices or smaller maps need less\",\"field\":\"\"}}\n";
    [[maybe_unused]] const ssize_t written = ::write(STDOUT_FILENO, words, sizeof words - 1);
    _exit(4);
}

/// When the memory of the machine or of the service's unit is used up, the kernel ends a worker and not the daemon.
void offer_to_the_kernel() {
    const int file = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
    if (file < 0) return;
    [[maybe_unused]] const ssize_t written = ::write(file, "500", 3);
    ::close(file);
}

}  // namespace

void report_memory_exhaustion() {
    std::set_new_handler(say_out_of_memory);
    // Threads of libraries do not catch bad_alloc.
    std::set_terminate([] {
        try {
            if (std::current_exception()) std::rethrow_exception(std::current_exception());
        } catch (const std::bad_alloc&) {
            say_out_of_memory();
        } catch (const std::system_error& error) {  // no memory for a thread's stack
            if (error.code() == std::errc::resource_unavailable_try_again) say_out_of_memory();
        } catch (...) {
        }
        std::abort();
    });
}

void apply(const Limits& limits) {
    offer_to_the_kernel();
    if (limits.parent != 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != limits.parent) throw Error(ErrorKind::cancelled, "the daemon is gone");
    }
    set_limit(RLIMIT_DATA, limits.memory_bytes);
    set_limit(RLIMIT_CPU, limits.cpu_seconds, 5);
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
}

}  // namespace hairbake
