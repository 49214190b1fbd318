// Ctrl-C, SIGTERM and SIGHUP: an orderly stop, then a hard stop if the orderly one takes too long.
#pragma once

#include <functional>
#include <thread>

#include "core/base/progress.h"

namespace hairbake {

/// Blocks SIGINT, SIGTERM and SIGHUP in this thread and all that it starts later, so that SignalWatch alone receives
/// them; ignores SIGPIPE and SIGXFSZ, whose failures show as errors of the write. SIGHUP stays ignored where it is
/// (nohup). Call it at the start of main().
void block_signals();

/// While it lives, a signal cancels `progress`. When the process still runs 0.8 s later, or a second signal comes,
/// `clean_up` is called and the process ends with the exit code of `cancelled`. No handler runs in signal context.
class SignalWatch {
public:
    SignalWatch(Progress& progress, std::function<void()> clean_up);

private:
    std::jthread thread_;
};

}  // namespace hairbake
