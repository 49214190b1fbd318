// hairbake info
#include <CLI/CLI.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/output.h"
#include "clients/cli/signal_watch.h"
#include "core/tools/inspect.h"

namespace hairbake {

void add_info_command(CLI::App& app, Action& action) {
    struct Options {
        std::string path;
        bool json = false;
    };
    CLI::App* command = app.add_subcommand("info", "Facts of a hair model, a mesh, an environment or a result folder");
    const auto options = std::make_shared<Options>();
    command->add_option("path", options->path, "file, folder or pattern with {face}")->required()->type_name("FILE");
    command->add_flag("--json", options->json, "as JSON");
    command->callback([options, &action] {
        action = [options] {
            Progress progress;
            const SignalWatch watch(progress, [] {});
            const std::string facts = inspect(options->path, progress);
            print_text(options->json ? facts + "\n" : as_lines(facts));
        };
    });
}

}  // namespace hairbake
