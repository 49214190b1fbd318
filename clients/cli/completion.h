// Scripts that complete the command line in a shell, made from the table of options.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace hairbake {

/// What a shell offers for a value.
enum class Completes {
    nothing,  ///< a number, an id: the user types it
    flag,     ///< there is no value
    file,
    folder,
    words,  ///< CompletedOption::words
    list,   ///< words with commas between them
    field   ///< a path of the request, "=", and a value: words are the paths
};

struct CompletedOption {
    std::string name;  ///< "--hair"; empty for an argument without a name
    std::string help;  ///< one line
    Completes completes = Completes::nothing;
    std::vector<std::string> words;
    bool repeats = false;  ///< may be given more than once
};

struct CompletedCommand {
    std::string name, help;
    std::vector<CompletedOption> options;    ///< those with a name
    std::vector<CompletedOption> arguments;  ///< those without
};

/// The commands of the program with their options.
std::vector<CompletedCommand> completed_commands(CLI::App& app);

/// The scripts. Each is sourced by its shell.
std::string bash_completion(const std::vector<CompletedCommand>& commands);
std::string zsh_completion(const std::vector<CompletedCommand>& commands);
std::string fish_completion(const std::vector<CompletedCommand>& commands);

}  // namespace hairbake
