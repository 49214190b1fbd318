// Parsing and checking of request targets and header values.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hairbake {

/// "%41%2f" -> "A/". Nothing for a broken escape or a control character.
std::optional<std::string> percent_decoded(const std::string& text);

struct Target {
    std::vector<std::string> path;
    std::map<std::string, std::string> query;
};

/// Parses "/v1/bakes?limit=5" and decodes its segments. Nothing when it is not a plain absolute path: it has an empty
/// or dotted segment, an encoded slash or control character, or a fragment.
std::optional<Target> read_target(const std::string& text);

/// Whether a header value has a control character other than a tab.
bool has_control_characters(const std::string& value);

/// Reads a decimal number without sign. Nothing for other texts and for an overflow.
std::optional<std::uint64_t> read_length(const std::string& text);

}  // namespace hairbake
