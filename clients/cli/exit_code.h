// The exit codes, one for each kind of failure.
#pragma once

#include <functional>
#include <string>

#include "core/base/error.h"

namespace hairbake {

enum class ExitCode {
    ok = 0,
    internal = 1,
    usage = 2,
    bad_input = 3,
    out_of_resources = 4,
    cancelled = 5,
    unreachable = 6,
    refused = 7,
    bake_failed = 8,
    bake_cancelled = 9
};

/// A failure of a command that talks to a service.
class RemoteError : public Error {
public:
    RemoteError(ExitCode code, const std::string& message, std::string field = {})
        : Error(ErrorKind::bad_input, message, std::move(field)), code_(code) {}

    ExitCode code() const { return code_; }

private:
    ExitCode code_;
};

/// "usage", "bad input" ...
std::string name_of(ExitCode code);

/// The table for --help, and the one for commands that talk to a service.
std::string exit_code_help();
std::string remote_exit_code_help();

struct Failure {
    ExitCode code;
    std::string message, field;
};

/// The exception that is being handled. Out of memory and full disks are out_of_resources. Unexpected exceptions are
/// internal.
Failure current_failure();

/// Runs `work`. With the progress mode "json" it also prints a failure as a JSON line.
/// Throws the exceptions of `work`.
void with_json_failures(const std::string& progress_mode, const std::function<void()>& work);

}  // namespace hairbake
