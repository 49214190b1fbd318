// The exit codes, one for each kind of failure.
#pragma once

#include <string>

#include "core/base/error.h"

namespace hairbake {

enum class ExitCode { ok = 0, internal = 1, usage = 2, bad_input = 3, out_of_resources = 4, cancelled = 5 };

ExitCode exit_code(ErrorKind kind);

/// "usage", "bad input" ...
std::string name_of(ErrorKind kind);

/// The table for --help.
std::string exit_code_help();

/// The exception that is being handled as an Error: out of memory and full disks are out_of_resources, what
/// hairbake did not expect is internal.
Error current_error();

}  // namespace hairbake
