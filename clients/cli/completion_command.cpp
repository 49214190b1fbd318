// hairbake completion
#include <CLI/CLI.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/completion.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"

namespace hairbake {

void add_completion_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("completion", "Print a script that completes the command line in a shell");
    const auto shell = std::make_shared<std::string>();
    command->add_option("shell", *shell, "bash, zsh or fish")
        ->required()
        ->check(one_of({"bash", "zsh", "fish"}))
        ->type_name("SHELL");
    command->footer(
        "bash: source <(hairbake completion bash)\n"
        "zsh:  hairbake completion zsh >FOLDER/_hairbake, where FOLDER is in $fpath\n"
        "fish: hairbake completion fish >~/.config/fish/completions/hairbake.fish\n"
        "`cmake --install` and `./dev install-programs` install all three.\n\n" +
        command->get_footer());
    command->callback([shell, &app, &action] {
        action = [shell, &app] {
            const auto commands = completed_commands(app);
            print_text(*shell == "bash"  ? bash_completion(commands)
                       : *shell == "zsh" ? zsh_completion(commands)
                                         : fish_completion(commands));
        };
    });
}

}  // namespace hairbake
