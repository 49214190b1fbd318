#include "clients/cli/option_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/base/number_text.h"
#include "core/base/short_number.h"

namespace hairbake {
namespace {

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

CLI::Validator one_of(std::vector<std::string> words) {
    return {[words = std::move(words)](std::string& text) -> std::string {
                if (std::find(words.begin(), words.end(), text) != words.end()) return {};
                std::string list;
                for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
                return "is " + text + "; allowed is one of " + list;
            },
            ""};
}

}  // namespace hairbake
