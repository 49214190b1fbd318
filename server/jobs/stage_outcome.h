// What an exception during the run of a stage means for the stage.
#pragma once

#include <stdexcept>

#include "server/jobs/task_follower.h"

namespace hairbake {

/// A worker reported success, and its result is not as it should be.
struct WrongResult : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A result that the store cannot hold, also if it held nothing else.
struct ResultTooLarge : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The end of the stage for the exception that is being handled. Only what an input causes is End::failed, and a result
/// that is too large. A wrong result is End::died. All else is End::trouble: the machine is at fault, or has no room
/// now.
Outcome outcome_of_exception();

}  // namespace hairbake
