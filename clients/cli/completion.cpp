#include "clients/cli/completion.h"

#include <CLI/CLI.hpp>

#include "clients/cli/option_values.h"

namespace hairbake {
namespace {

/// Up to the first semicolon or line end: a shell shows one line for each option.
std::string short_help(const std::string& help) { return help.substr(0, help.find_first_of(";\n")); }

Completes kind_of(CLI::Option& option, const std::vector<std::string>& words) {
    const std::string type = option.get_type_name();
    if (option.get_expected_max() == 0 || option.get_type_size() == 0) return Completes::flag;
    if (type == "PATH=VALUE") return Completes::field;
    if (!words.empty()) return type == "LIST" ? Completes::list : Completes::words;
    if (type.starts_with("DIR")) return type.find('.') == std::string::npos ? Completes::folder : Completes::file;
    const bool file = type.starts_with("FILE") || type.find('.') != std::string::npos;
    return file ? Completes::file : Completes::nothing;
}

CompletedOption completed_option(CLI::Option& option) {
    CompletedOption completed;
    if (!option.get_lnames().empty()) completed.name = "--" + option.get_lnames().front();
    completed.help = short_help(option.get_description());
    completed.words = offered_words(option);
    completed.completes = kind_of(option, completed.words);
    completed.repeats = option.get_items_expected_max() > 1;
    return completed;
}

}  // namespace

std::vector<CompletedCommand> completed_commands(CLI::App& app) {
    std::vector<CompletedCommand> commands;
    for (CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        CompletedCommand completed{command->get_name(), short_help(command->get_description()), {}, {}};
        for (CLI::Option* option : command->get_options([](const CLI::Option*) { return true; })) {
            CompletedOption found = completed_option(*option);
            (found.name.empty() ? completed.arguments : completed.options).push_back(std::move(found));
        }
        commands.push_back(std::move(completed));
    }
    return commands;
}

}  // namespace hairbake
