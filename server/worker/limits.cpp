#include "server/worker/limits.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "core/base/error.h"

namespace hairbake {
namespace {

void set_limit(__rlimit_resource resource, std::uint64_t value) {
    if (value == 0) return;
    const rlimit limit{value, value};
    if (::setrlimit(resource, &limit) != 0) throw Error(ErrorKind::internal, "a limit of the worker cannot be set");
}

}  // namespace

void apply(const Limits& limits) {
    if (limits.parent != 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != limits.parent) throw Error(ErrorKind::cancelled, "the daemon is gone");
    }
    set_limit(RLIMIT_DATA, limits.memory_bytes);
    set_limit(RLIMIT_CPU, limits.cpu_seconds);
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
}

}  // namespace hairbake
