#include "clients/cli/option_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/base/number_text.h"
#include "core/base/short_number.h"

namespace hairbake {
namespace {

constexpr std::string_view words_mark = "words";

/// The shortest text that gives the same double.
std::string exact(double value) {
    std::array<char, 32> buffer{};
    return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

CLI::Validator checked_number(double low, double high, bool whole, const std::string& allowed) {
    return {[=](std::string& text) -> std::string {
                const std::optional<double> value = number_of(text);
                const bool fits = value && *value >= low && *value <= high && (!whole || *value == std::floor(*value));
                if (!fits) return "is " + text + "; allowed is " + allowed;
                text = whole ? short_number(*value) : exact(*value);  // in the form that CLI11 reads
                return {};
            },
            ""};
}

std::string range(double low, double high) { return short_number(low) + " to " + short_number(high); }

[[noreturn]] void throw_triple(const std::string& name, const std::string& text, double low, double high) {
    const bool bounded = high < std::numeric_limits<double>::max();
    throw CLI::ValidationError(name, "is " + text + "; allowed are three numbers with commas between them" +
                                         (bounded ? ", each " + range(low, high) : std::string()));
}

}  // namespace

CLI::Validator whole_number(double low, double high) {
    return checked_number(low, high, true, "a whole number from " + range(low, high));
}

CLI::Validator number(double low, double high) { return checked_number(low, high, false, range(low, high)); }

CLI::Validator any_number() {
    constexpr double most = std::numeric_limits<double>::max();
    return checked_number(-most, most, false, "a number");
}

CLI::Option* add_triple(CLI::App& command, const std::string& name, std::array<double, 3>& values, double low,
                        double high, const std::string& help) {
    const auto take = [=, &values](const std::string& text) {
        std::vector<double> taken;
        for (const std::string& part : CLI::detail::split(text, ','))
            if (const std::optional<double> value = number_of(part); value && *value >= low && *value <= high)
                taken.push_back(*value);
            else
                throw_triple(name, text, low, high);
        if (taken.size() != values.size()) throw_triple(name, text, low, high);
        std::copy(taken.begin(), taken.end(), values.begin());
    };
    return command.add_option_function<std::string>(name, take, help);
}

std::string name_with_words(const std::vector<std::string>& words) {
    std::string name(words_mark);
    for (const std::string& word : words) name += ' ' + word;
    return name;
}

CLI::Validator one_of(std::vector<std::string> words) {
    const std::string name = name_with_words(words);
    return {[words = std::move(words)](std::string& text) -> std::string {
                if (std::find(words.begin(), words.end(), text) != words.end()) return {};
                std::string list;
                for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
                return "is " + text + "; allowed is one of " + list;
            },
            "", name};
}

CLI::Validator offering(const std::vector<std::string>& words) {
    return {[](std::string&) { return std::string(); }, "", name_with_words(words)};
}

std::vector<std::string> offered_words(CLI::Option& option) {
    std::vector<std::string> words;
    try {
        for (int i = 0;; ++i) {  // ends with an exception: CLI11 does not tell the number
            const std::string name = option.get_validator(i)->get_name();
            if (name.starts_with(std::string(words_mark) + " "))
                for (const std::string& word : CLI::detail::split(name.substr(words_mark.size() + 1), ' '))
                    words.push_back(word);
        }
    } catch (const CLI::OptionNotFound&) {
        return words;
    }
}

}  // namespace hairbake
