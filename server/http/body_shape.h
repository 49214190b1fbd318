// Bounds of a JSON body that hold before its values take memory: depth, lengths of lists and texts, known fields.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hairbake {

/// Parses the text without keeping its values, and ends at the first error. A list has at most the schema's `maxItems`
/// (64 without it), a text at most `maxLength`, an object each of its known fields once. A list or object stands only
/// where the schema names it, so the values of a body that passes take a few times its bytes. Thread-safe.
/// Throws Refusal(malformed) when it is no JSON, nested too deeply, or has a text or number of more than 32 KiB.
/// Throws Refusal(unprocessable) naming the field, what was found and what is allowed.
void check_shape(const std::string& text, const nlohmann::json& schema);

}  // namespace hairbake
