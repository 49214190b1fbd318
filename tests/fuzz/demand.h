// Checks of the promises that a fuzz target makes for every input.
#pragma once

#include <cstdlib>
#include <iostream>

namespace hairbake {

/// Ends the run with a finding unless `ok`. `what` names the promise.
inline void demand(bool ok, const char* what) {
    if (ok) return;
    std::cerr << "broken promise: " << what << "\n";
    std::abort();
}

}  // namespace hairbake
