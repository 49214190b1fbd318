#include "clients/cli/parse_failure.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "core/base/spelling.h"

namespace hairbake {
namespace {

/// The command that was given; the program itself where there was none.
const CLI::App& command_of(const CLI::App& app) {
    const std::vector<CLI::App*> given = app.get_subcommands();
    return given.empty() ? app : *given.front();
}

std::vector<std::string> options_of(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
    const auto everything = [](const CLI::App*) { return true; };
    return app.get_subcommands(everything);
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
    return names;
}

std::string joined(const std::vector<std::string>& words) {
    std::string list;
    for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
    return list;
}

std::string see_help(const CLI::App& command, const CLI::App& app) {
    const std::string name = &command == &app ? "hairbake" : "hairbake " + command.get_name();
    return "; \"" + name + " --help\" tells more";
}

std::string unknown_option(const std::string& typed, const CLI::App& command, const CLI::App& app) {
    const std::string name = typed.substr(0, typed.find('='));
    std::string text = "there is no option " + typed;
    if (&command != &app) text = command.get_name() + " has no option " + typed;
    std::vector<std::string> others;
    for (const CLI::App* other : commands_of(app)) {
        const std::vector<std::string> names = options_of(*other);
        if (std::find(names.begin(), names.end(), name) != names.end()) others.push_back(other->get_name());
    }
    if (!others.empty()) return text + "; it is an option of " + joined(others);
    return text + did_you_mean(name, options_of(command)) + see_help(command, app);
}

/// What was typed and understood by nobody; empty where there is nothing.
std::string unknown_words(const CLI::App& app, std::span<char* const> arguments) {
    const CLI::App& command = command_of(app);
    const std::vector<std::string> left = app.remaining(true);
    const auto is_left = [&](const std::string& word) {
        return std::find(left.begin(), left.end(), word) != left.end();
    };
    for (const std::string word : arguments)
        if (word.size() > 1 && word[0] == '-' && is_left(word)) return unknown_option(word, command, app);
    for (const std::string& word : left)
        if (word.size() > 1 && word[0] == '-') return unknown_option(word, command, app);
    if (left.empty()) return {};
    if (&command == &app)
        return "there is no command " + left[0] + did_you_mean(left[0], names_of_commands(app)) + "; allowed are " +
               joined(names_of_commands(app));
    return command.get_name() + " takes no " + (left.size() > 1 ? "arguments " : "argument ") + joined(left) +
           " at this place" + see_help(command, app);
}

/// "--size needs a value", "--target needs 3 numbers".
std::string wrong_count(const CLI::ParseError& error, const CLI::App& command) {
    const std::string text = error.what(), name = text.substr(0, text.find(':'));
    const CLI::Option* option = command.get_option_no_throw(name);
    if (!option) return text;
    const auto given = option->results().size();
    const int wanted = option->get_type_size_max();
    if (wanted > 1)
        return name + " is " + (given == 0 ? "given without a value" : joined(option->results())) + "; allowed are " +
               std::to_string(wanted) + " numbers with commas between them";
    return given == 0 ? name + " needs a value"
                      : name + " is given " + std::to_string(given) + " times; allowed is once";
}

}  // namespace

std::string words_for_one_dash(const CLI::App& app, std::span<char* const> arguments) {
    for (const std::string word : arguments) {
        if (!word.starts_with("-h") || word.size() == 2) continue;
        const std::string first = arguments[0];
        for (const CLI::App* command : commands_of(app))
            if (command->get_name() == first) return unknown_option(word, *command, app);
        return unknown_option(word, app, app);
    }
    return {};
}

std::string words_for(const CLI::ParseError& error, const CLI::App& app, std::span<char* const> arguments) {
    if (const std::string unknown = unknown_words(app, arguments); !unknown.empty()) return unknown;
    const CLI::App& command = command_of(app);
    std::string text = error.what();
    if (dynamic_cast<const CLI::RequiredError*>(&error)) {
        if (&command == &app) return "no command is given; allowed are " + joined(names_of_commands(app));
        return command.get_name() + ": " + text + see_help(command, app);
    }
    if (dynamic_cast<const CLI::ValidationError*>(&error)) {
        if (const std::size_t at = text.find(": is "); at != std::string::npos) text.erase(at, 1);
        return text;
    }
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) return wrong_count(error, command);
    if (dynamic_cast<const CLI::ExcludesError*>(&error))
        if (const std::size_t at = text.find(" excludes "); at != std::string::npos)
            return text.replace(at, 10, " and ") + " are given; allowed is one of them";
    return text;
}

}  // namespace hairbake
