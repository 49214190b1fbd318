// The reason of a JSON error, for people.
#pragma once

#include <exception>
#include <string>

namespace hairbake {

/// What the JSON library says, in plain words: without the number of its exception at the beginning
/// ("[json.exception.parse_error.101] "), and for a number that is too large and a broken surrogate pair with what is
/// allowed. Other exceptions keep their text.
inline std::string json_reason(const std::exception& error) {
    const std::string text = error.what();
    const std::size_t end = text.starts_with("[json.exception.") ? text.find("] ") : std::string::npos;
    if (end == std::string::npos) return text;
    const std::string reason = text.substr(end + 2), overflow = "number overflow parsing '";
    if (reason.starts_with(overflow))
        return "the number " + reason.substr(overflow.size(), reason.size() - overflow.size() - 1) +
               " is too large; allowed are numbers up to 1.797e308";
    if (const std::size_t surrogate = reason.find("invalid string: surrogate"); surrogate != std::string::npos)
        return "a text has one half of a pair \\uD800 to \\uDBFF, \\uDC00 to \\uDFFF; allowed are both halves in this "
               "order, or the character itself";
    return reason;
}

}  // namespace hairbake
