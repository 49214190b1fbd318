// hairbake diff
#include <CLI/CLI.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"
#include "clients/cli/signal_watch.h"
#include "core/tools/diff.h"

namespace hairbake {

void add_diff_command(CLI::App& app, Action& action) {
    struct Options {
        std::string first, second;
        std::optional<std::string> picture;
        std::optional<double> scale;
        bool json = false;
    };
    CLI::App* command = app.add_subcommand("diff", "Difference of two linear pictures (second minus first)");
    const auto options = std::make_shared<Options>();
    command->add_option("first", options->first, "picture")->required()->type_name("A.exr");
    command->add_option("second", options->second, "picture")->required()->type_name("B.exr");
    command->add_option("--out", options->picture, "write the difference in false colours")->type_name("DIFF.png");
    command
        ->add_option("--scale", options->scale,
                     "difference drawn in the brightest colour; default: the largest, rounded up")
        ->transform(any_number())
        ->type_name("X");
    command->add_flag("--json", options->json, "figures as JSON");
    command->callback([options, &action] {
        action = [options] {
            Progress progress;
            const SignalWatch watch(progress, [options] {
                if (options->picture) discard_diff_part(*options->picture);
            });
            const std::string report =
                diff(options->first, options->second, options->picture, options->scale, progress);
            print_text(options->json ? report + "\n" : diff_as_lines(report));
        };
    });
}

}  // namespace hairbake
