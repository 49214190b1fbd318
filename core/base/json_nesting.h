// How deep JSON text is nested, looked at before it is parsed: what comes after the parser recurses (copies, dumps).
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"

namespace hairbake {

/// Of requests and manifests; what hairbake writes itself has fewer than ten levels.
inline constexpr int deepest_json = 64;

/// Whether more than `levels` lists and objects lie in one another; brackets in strings do not count. Text that is
/// not JSON is judged by its brackets all the same.
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

/// Throws Error(kind) that begins with `source` for JSON of more than deepest_json levels.
inline void check_nesting(std::string_view json, const std::string& source, ErrorKind kind,
                          const std::string& field = {}) {
    if (nested_deeper_than(json, deepest_json))
        throw Error(kind, source + " is nested deeper than " + std::to_string(deepest_json) + " levels", field);
}

}  // namespace hairbake
