// Request targets and header values, taken apart and checked.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hairbake {

/// "%41%2f" -> "A/"; nothing for a broken escape or a control character.
std::optional<std::string> percent_decoded(const std::string& text);

struct Target {
    std::vector<std::string> path;
    std::map<std::string, std::string> query;
};

/// "/v1/bakes?limit=5" taken apart, segments decoded. Nothing for what is no plain absolute path: an empty or dotted
/// segment, an encoded slash or control character, a fragment.
std::optional<Target> read_target(const std::string& text);

/// Whether a header value has a control character other than a tab.
bool has_control_characters(const std::string& value);

/// Digits only, no sign, no overflow.
std::optional<std::uint64_t> read_length(const std::string& text);

}  // namespace hairbake
