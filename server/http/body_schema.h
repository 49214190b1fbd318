// JSON bodies, checked against the schemas that /openapi.json publishes.
#pragma once

#include <string>

#include "server/http/message.h"

namespace hairbake {

/// The body as text, valid by the schema of that name in components.schemas. The router has limited its length.
/// Throws Refusal(malformed) when it is no JSON or nested too deeply.
/// Throws Refusal(unprocessable) naming the field, what was found and what is allowed.
std::string read_json(const HttpRequest& request, const std::string& schema);

/// The same check of `text` by the schema `name`. Thread-safe.
void check_json(const std::string& text, const std::string& name);

}  // namespace hairbake
