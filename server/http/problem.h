// Errors as application/problem+json (RFC 9457).
#pragma once

#include <string>

#include "server/http/message.h"

namespace hairbake {

/// `slug` makes the stable type, urn:hairbake:problem:<slug>; `field` is the field at fault or empty,
/// `pointer` the JSON pointer to it when it is one of the body.
HttpReply problem(int status, const std::string& slug, const std::string& detail, const std::string& field = {},
                  const std::string& pointer = {});

/// The problem of a status code that the HTTP library answers with by itself.
HttpReply problem_of_status(int status);

/// The exception that is being handled; what is not expected becomes a 500 that tells nothing of the inside.
HttpReply problem_of_current_exception();

}  // namespace hairbake
