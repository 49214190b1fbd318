#include "clients/cli/common_flags.h"

#include <CLI/CLI.hpp>

#include "clients/cli/messages.h"
#include "clients/cli/option_values.h"
#include "core/base/parallel.h"

namespace hairbake {

void add_progress_flag(CLI::App& command, std::string& mode) {
    command.add_option("--progress", mode, "auto (a bar on a terminal), json (lines on standard output) or none")
        ->check(one_of({"auto", "json", "none"}))
        ->type_name("MODE")
        ->capture_default_str();
}

void add_threads_flag(CLI::App& command, int& threads) {
    command.add_option("--threads", threads, "threads, 0 to 1024; 0: one per core")
        ->transform(whole_number(0, 1024))
        ->type_name("N")
        ->capture_default_str();
}

void warn_of_threads(int threads) {
    const int cores = thread_count();
    if (threads > cores)
        say_warning("--threads is " + std::to_string(threads) + ", but this process has " + std::to_string(cores) +
                    (cores == 1 ? " core" : " cores") + ": more threads than cores only take turns");
}

}  // namespace hairbake
