// The reason of a JSON error, for people.
#pragma once

#include <exception>
#include <string>

namespace hairbake {

/// What the JSON library says, without the number of its exception at the beginning ("[json.exception.parse_error.101]
/// ").
inline std::string json_reason(const std::exception& error) {
    const std::string text = error.what();
    const std::size_t end = text.starts_with("[json.exception.") ? text.find("] ") : std::string::npos;
    return end == std::string::npos ? text : text.substr(end + 2);
}

}  // namespace hairbake
