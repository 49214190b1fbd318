// Flags that several commands have.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace hairbake {

/// --progress, "auto" by default.
void add_progress_flag(CLI::App& command, std::string& mode);

/// --threads, 0 by default: one per core.
void add_threads_flag(CLI::App& command, int& threads);

/// Says on standard error that there are more threads than cores.
void warn_of_threads(int threads);

}  // namespace hairbake
