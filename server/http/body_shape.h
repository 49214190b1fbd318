// Bounds of a JSON body that hold before its values take memory: lengths of lists and texts, known fields.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hairbake {

/// Parses the text without keeping its values, and ends at the first error. A list has at most the schema's `maxItems`
/// (64 without it), a text at most `maxLength`, an object each of its known fields once. A list or object stands only
/// where the schema names it, so the values of a body that passes take a few times its bytes, and are nested no deeper
/// than the schema. Thread-safe.
/// Throws Refusal(malformed) when it is no JSON, or not in UTF-8.
/// Throws Refusal(unprocessable) naming the field, what was found and what is allowed; also for a text or number of
/// more than 32 KiB.
void check_shape(const std::string& text, const nlohmann::json& schema);

}  // namespace hairbake
