// The one exception type of hairbake. Its kind decides the command line's exit code and the service's answer.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/short_text.h"

namespace hairbake {

enum class ErrorKind {
    usage,             ///< the request is wrong: an unknown field, a value out of range
    bad_input,         ///< a file is missing, broken or hostile
    out_of_resources,  ///< memory, disk
    cancelled,         ///< the caller asked to stop
    internal           ///< a defect of hairbake
};

/// The message is for the person who gave the input: it names the file, the place in it, what was found and what is
/// allowed. `field` is the request field at fault ("transmittance.voxels") or empty. `system_error` is the system's
/// error number (errno) where a call of the system failed, or 0. The machine is then at fault, and not what a file
/// holds. Control characters in the message are shown as escapes, line ends excepted.
class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, const std::string& message, std::string field = {}, int system_error = 0)
        : std::runtime_error(escaped(message, "\n")),
          kind_(kind),
          field_(std::move(field)),
          system_error_(system_error) {}

    ErrorKind kind() const { return kind_; }
    const std::string& field() const { return field_; }
    int system_error() const { return system_error_; }

private:
    ErrorKind kind_;
    std::string field_;
    int system_error_;
};

}  // namespace hairbake
