// hairbake compare
#include <CLI/CLI.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/output.h"
#include "clients/cli/signal_watch.h"
#include "core/tools/compare.h"

namespace hairbake {

void add_compare_command(CLI::App& app, Action& action) {
    struct Options {
        std::string first, second;
        bool json = false;
    };
    CLI::App* command = app.add_subcommand("compare", "Difference statistics of two results (second minus first)");
    const auto options = std::make_shared<Options>();
    command->add_option("first", options->first, "result folder")->required()->type_name("DIR1");
    command->add_option("second", options->second, "result folder")->required()->type_name("DIR2");
    command->add_flag("--json", options->json, "as JSON");
    command->callback([options, &action] {
        action = [options] {
            Progress progress;
            const SignalWatch watch(progress, [] {});
            const std::string report = compare(options->first, options->second);
            print_text(options->json ? report + "\n" : as_table(report));
        };
    });
}

}  // namespace hairbake
