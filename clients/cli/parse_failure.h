// Errors of the arguments, in words for people.
#pragma once

#include <span>
#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace hairbake {

/// What is wrong, and what to do. An option or command that does not exist is reported before all else, as it was
/// typed, with the one that may have been meant.
///   arguments: those of main(), without the program
std::string words_for(const CLI::ParseError& error, const CLI::App& app, std::span<char* const> arguments);

/// "-hair" where "--hair" was meant: the parser would take it for -h and show the help. Empty where there is none.
std::string words_for_one_dash(const CLI::App& app, std::span<char* const> arguments);

}  // namespace hairbake
