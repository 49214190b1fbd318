// The check of a JSON body against the schemas that /openapi.json publishes.
#pragma once

#include <string>

namespace hairbake {

/// Checks `text` by the schema of that name in components.schemas. It takes a few times the text's bytes while it runs,
/// whatever the text is. Thread-safe.
/// Throws Refusal(malformed) when it is no JSON.
/// Throws Refusal(unprocessable) naming the field, what was found and what is allowed.
void check_json(const std::string& text, const std::string& name);

}  // namespace hairbake
