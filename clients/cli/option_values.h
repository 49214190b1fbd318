// What the options of the command line take, with messages for people. A message follows the option's name: "--threads
// is -1; allowed is 0 to 1024".
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <vector>

#include "core/base/names.h"

namespace hairbake {

/// A whole number in [low, high], also as "+5", "5." or "5e0".
CLI::Validator whole_number(double low, double high);

/// A number in [low, high], also as ".5", "1." or "+5".
CLI::Validator number(double low, double high);

/// Any number.
CLI::Validator any_number();

/// Adds an option that takes three numbers in [low, high] with commas between them.
CLI::Option* add_triple(CLI::App& command, const std::string& name, std::array<double, 3>& values, double low,
                        double high, const std::string& help);

/// One of these words.
CLI::Validator one_of(std::vector<std::string> words);

/// Checks nothing. The completion of the shell offers these words for the option (offered_words()).
CLI::Validator offering(const std::vector<std::string>& words);

/// The words of the option's validators one_of(), name_in_table() and offering(). They travel in the validators' names,
/// because CLI11 has no other place for them.
std::vector<std::string> offered_words(CLI::Option& option);

/// The name of a validator that carries `words`.
std::string name_with_words(const std::vector<std::string>& words);

/// The name of a value of an enum.
template <class Enum, std::size_t count>
CLI::Validator name_in_table(const std::array<EnumName<Enum>, count>& table) {
    std::vector<std::string> words;
    for (const EnumName<Enum>& entry : table) words.emplace_back(entry.name);
    return {[table](std::string& text) -> std::string {
                const std::optional<Enum> value = find_in(table, text);
                if (!value) return "is " + text + "; allowed is one of " + list_names(table);
                text = std::to_string(static_cast<int>(*value));  // which CLI11 reads into an enum
                return {};
            },
            "", name_with_words(words)};
}

}  // namespace hairbake
