// Numbers as people write them: .05, 1., +5, 1e3.
#pragma once

#include <cctype>
#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace hairbake {

/// The number that `text` is as a whole: a sign or none, decimal digits with or without a point, an exponent or none.
/// Empty for any other text, also for words (inf, nan), hexadecimal digits and numbers beyond double precision.
inline std::optional<double> number_of(std::string_view text) {
    const bool signed_text = text.starts_with('+') || text.starts_with('-');
    const std::string_view digits = text.substr(signed_text ? 1 : 0);
    const bool begins_well =
        !digits.empty() && (std::isdigit(static_cast<unsigned char>(digits[0])) || digits[0] == '.');
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (!begins_well || error != std::errc() || end != digits.data() + digits.size()) return {};
    return text.starts_with('-') ? -value : value;
}

}  // namespace hairbake
