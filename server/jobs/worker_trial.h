// The trial of a worker: tells whether the machine or an input is at fault when a worker died.
#pragma once

#include <filesystem>
#include <functional>

#include "server/jobs/task_follower.h"

namespace hairbake {

/// Has a worker bake a small sample that needs no input (server/worker/trial.h). Blocks until it has ended. The machine
/// can bake when the outcome is `done`; then the worker is of the daemon's version, too. A trial that takes more than a
/// minute has failed. Never throws.
/// - incoming: the store's folder for incoming files.
/// - wish: as in follow_task(), without `leave`.
Outcome run_trial(Runner& runner, const std::filesystem::path& incoming, const std::function<Wish()>& wish);

/// `death` (End::died, or an error of the kind `internal`) as it is when a trial is successful: then the task's input
/// may be at fault. Else End::trouble, with the trial's failure, or End::cancelled, by the wish. Never throws.
Outcome explain_death(Outcome death, Runner& runner, const std::filesystem::path& incoming,
                      const std::function<Wish()>& wish);

}  // namespace hairbake
