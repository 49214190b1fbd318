// Errors as application/problem+json (RFC 9457).
#pragma once

#include <string>

#include "server/http/message.h"

namespace hairbake {

/// A reply of the type urn:hairbake:problem:`slug`, which is stable.
///
/// `detail` tells what was found and what is allowed.
/// `field` is the field at fault, or empty.
/// `pointer` is the JSON pointer to the field in the body, or empty.
HttpReply problem(int status, const std::string& slug, const std::string& detail, const std::string& field = {},
                  const std::string& pointer = {});

/// The problem for a status code that the HTTP library chose by itself.
HttpReply problem_of_status(int status);

/// The problem for the exception that is being handled. Unexpected exceptions become a 500 without details.
HttpReply problem_of_current_exception();

}  // namespace hairbake
