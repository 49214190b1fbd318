// JSON bodies, checked against the schemas that /openapi.json publishes.
#pragma once

#include <string>

#include "server/http/message.h"

namespace hairbake {

/// The body as text, once the schema of that name in components.schemas takes it. Throws Refusal(malformed) for what is
/// no JSON or nested too deeply, Refusal(unprocessable) naming the field, what was found and what is allowed. It was
/// counted against the route's limit.
std::string read_json(const HttpRequest& request, const std::string& schema);

/// The same for a text and the schema `name`. Thread-safe.
void check_json(const std::string& text, const std::string& name);

}  // namespace hairbake
