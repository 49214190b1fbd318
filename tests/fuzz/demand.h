// What a fuzz target promises of every input.
#pragma once

#include <cstdlib>
#include <iostream>

namespace hairbake {

/// Ends the run, which is a finding, with `what` was promised and does not hold.
inline void demand(bool ok, const char* what) {
    if (ok) return;
    std::cerr << "broken promise: " << what << "\n";
    std::abort();
}

}  // namespace hairbake
