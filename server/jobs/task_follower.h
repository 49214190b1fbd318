// Follows a started worker to its end.
#pragma once

#include <functional>
#include <string>

#include "core/base/error.h"
#include "server/jobs/runner.h"
#include "server/jobs/work_folder.h"
#include "server/jobs/worker_words.h"

namespace hairbake {

/// How a task ended.
struct Outcome {
    enum class End {
        done,       ///< `facts` holds the worker's last word
        failed,     ///< `kind`, `message`, `field` hold the error; another attempt would fail, too
        trouble,    ///< the machine is at fault, as `message` tells; another attempt may be successful later
        died,       ///< without a last word; `message` tells how
        cancelled,  ///< stopped on the caller's wish
        left        ///< the caller left it: it still runs
    };
    End end = End::died;
    std::string facts = "{}";
    ErrorKind kind = ErrorKind::internal;
    std::string message, field;
    bool from_outside = false;  ///< of `died`: the system or another process ended the worker
};

/// What the caller of follow_task() wants at the moment.
enum class Wish { go_on, stop, leave };

/// Blocks until the worker has ended, or the wish is `leave`.
///
/// `handle` is what `runner` returned when it started a worker on `folder`.
/// `wish` is asked again and again; after `stop` the worker is stopped and the function waits for its end.
/// `on_progress` gets the worker's progress from the calling thread.
Outcome follow_task(Runner& runner, const std::string& handle, const WorkFolder& folder,
                    const std::function<Wish()>& wish, const WorkerWords::OnProgress& on_progress);

}  // namespace hairbake
