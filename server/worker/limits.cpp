#include "server/worker/limits.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>

#include "core/base/error.h"
#include "server/worker/shortage.h"

namespace hairbake {
namespace {

/// The hard limit is `grace` above the soft one. For CPU time the soft limit sends SIGXCPU, by which the daemon knows
/// the reason, and the hard limit sends SIGKILL.
void set_limit(__rlimit_resource resource, std::uint64_t value, std::uint64_t grace = 0) {
    if (value == 0) return;
    const rlimit limit{value, value + grace};
    if (::setrlimit(resource, &limit) != 0)
        throw Error(ErrorKind::internal, "a limit of the worker cannot be set", {}, errno);
}

constexpr std::uint64_t largest_stack = 16 << 20;
constexpr std::string_view limit_reached =
    "\n{\"error\":{\"kind\":\"out_of_resources\",\"message\":\"the worker's memory limit was reached; fewer "
    "voxels, vertices or smaller maps need less\",\"field\":\"\",\"machine\":false}}\n";
constexpr std::string_view memory_is_short =
    "\n{\"error\":{\"kind\":\"out_of_resources\",\"message\":\"the machine is short of memory\",\"field\":\"\","
    "\"machine\":true}}\n";
constexpr std::string_view threads_are_short =
    "\n{\"error\":{\"kind\":\"out_of_resources\",\"message\":\"no thread can be started: the machine is short of "
    "processes\",\"field\":\"\",\"machine\":true}}\n";

[[noreturn]] void end_with(std::string_view words) {
    [[maybe_unused]] const ssize_t written = ::write(STDOUT_FILENO, words.data(), words.size());
    _exit(4);
}

/// When the memory of the machine or of the service's unit is used up, the kernel ends a worker and not the daemon.
void offer_to_the_kernel() {
    const int file = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
    if (file < 0) return;
    [[maybe_unused]] const ssize_t written = ::write(file, "500", 3);
    ::close(file);
}

[[noreturn]] void say_out_of_memory() { end_with(machine_is_short_of_memory() ? memory_is_short : limit_reached); }

[[noreturn]] void say_no_thread() {
    if (memory_limit_refuses(largest_stack)) end_with(limit_reached);
    end_with(machine_is_short_of_memory() ? memory_is_short : threads_are_short);
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
        } catch (const std::system_error& error) {
            if (error.code() == std::errc::resource_unavailable_try_again) say_no_thread();
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
