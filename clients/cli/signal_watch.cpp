#include "clients/cli/signal_watch.h"

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include "clients/cli/exit_code.h"

namespace hairbake {
namespace {

sigset_t watched_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    // A blocked signal is kept even where it is ignored, so an ignored SIGHUP must not be blocked.
    struct sigaction hangup {};
    sigaction(SIGHUP, nullptr, &hangup);
    if (hangup.sa_handler != SIG_IGN) sigaddset(&set, SIGHUP);
    return set;
}

/// Whether a signal came within the time.
bool wait_for_signal(long milliseconds) {
    const sigset_t set = watched_signals();
    const timespec patience{milliseconds / 1000, milliseconds % 1000 * 1'000'000};
    return sigtimedwait(&set, nullptr, &patience) > 0;
}

void watch(const std::stop_token& stop, Progress& progress, const std::function<void()>& clean_up) {
    constexpr long look_ms = 40, patience_ms = 800;
    while (!wait_for_signal(look_ms))
        if (stop.stop_requested()) return;
    progress.cancel();
    for (long waited = 0; waited < patience_ms && !wait_for_signal(look_ms); waited += look_ms)
        if (stop.stop_requested()) return;
    clean_up();
    _exit(static_cast<int>(ExitCode::cancelled));  // runs no destructors, because other threads still work
}

}  // namespace

void block_signals() {
    // A shell starts background jobs with SIGINT ignored. The default is restored, so that kill -INT stops them too.
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    const sigset_t set = watched_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

SignalWatch::SignalWatch(Progress& progress, std::function<void()> clean_up)
    : thread_([&progress, clean_up = std::move(clean_up)](const std::stop_token& stop) {
          watch(stop, progress, clean_up);
      }) {}

}  // namespace hairbake
