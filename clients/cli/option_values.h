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

/// The name of a value of an enum.
template <class Enum, std::size_t count>
CLI::Validator name_in_table(const std::array<EnumName<Enum>, count>& table) {
    return {[table](std::string& text) -> std::string {
                const std::optional<Enum> value = find_in(table, text);
                if (!value) return "is " + text + "; allowed is one of " + list_names(table);
                text = std::to_string(static_cast<int>(*value));  // which CLI11 reads into an enum
                return {};
            },
            ""};
}

}  // namespace hairbake
