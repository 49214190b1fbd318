// The depth of JSON text, checked before it is parsed: copying and dumping a parsed value are recursive.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"

namespace hairbake {

/// For requests and manifests. hairbake itself writes fewer than ten levels.
inline constexpr int deepest_json = 64;

/// Whether lists and objects are nested more than `levels` deep. Brackets in strings do not count. Text that is not
/// JSON is judged by its brackets too.
inline bool nested_deeper_than(std::string_view json, int levels) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (c == '"') in_string = !in_string;
        if (in_string)
            i += c == '\\';  // and the character that it escapes
        else if (c == '[' || c == '{')
            ++depth;
        else if (c == ']' || c == '}')
            --depth;
        if (depth > levels) return true;
    }
    return false;
}

/// `source` names the text in messages.
/// Throws Error(kind) for JSON of more than deepest_json levels; its message begins with `source`.
inline void check_nesting(std::string_view json, const std::string& source, ErrorKind kind,
                          const std::string& field = {}) {
    if (nested_deeper_than(json, deepest_json))
        throw Error(kind, source + " is nested deeper than " + std::to_string(deepest_json) + " levels", field);
}

}  // namespace hairbake
