// The exception for a request that the service refuses.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/short_text.h"

namespace hairbake {

enum class Refused {
    malformed,      ///< not of the form that the route takes
    unprocessable,  ///< well-formed, and a field's value is not allowed
    not_found,
    gone,        ///< it was there and was removed
    conflict,    ///< with the present state of the service
    too_large,   ///< more bytes than allowed
    too_many,    ///< one token has too many of something
    too_slow,    ///< the body did not arrive in time
    full,        ///< the store's budget is used up
    unwritable,  ///< the system does not let the daemon write its files
    busy         ///< try again later
};

/// `field` is the field at fault or empty. The message tells what was found and what is allowed; control characters in
/// it are shown as escapes.
class Refusal : public std::runtime_error {
public:
    Refusal(Refused why, const std::string& message, std::string field = {})
        : std::runtime_error(escaped(message)), why_(why), field_(std::move(field)) {}

    Refused why() const { return why_; }
    const std::string& field() const { return field_; }
    /// Seconds after which the client should try again; 0 where the reason alone decides.
    int retry_s() const { return retry_s_; }
    Refusal& retry_after(int seconds) {
        retry_s_ = seconds;
        return *this;
    }
    /// JSON pointer to the field in the request's body, or empty.
    const std::string& pointer() const { return pointer_; }
    Refusal& at(std::string pointer) {
        pointer_ = std::move(pointer);
        return *this;
    }
    /// Of a conflict: what refers to the object, as the JSON object that the reply shows as needed_by; or empty.
    const std::string& needed_by() const { return needed_by_; }
    Refusal& because_of(std::string json) {
        needed_by_ = std::move(json);
        return *this;
    }

private:
    Refused why_;
    std::string field_, pointer_, needed_by_;
    int retry_s_ = 0;
};

}  // namespace hairbake
