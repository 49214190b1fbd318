#include "clients/cli/exit_code.h"

#include <new>
#include <system_error>

namespace hairbake {

ExitCode exit_code(ErrorKind kind) {
    switch (kind) {
        case ErrorKind::usage:
            return ExitCode::usage;
        case ErrorKind::bad_input:
            return ExitCode::bad_input;
        case ErrorKind::out_of_resources:
            return ExitCode::out_of_resources;
        case ErrorKind::cancelled:
            return ExitCode::cancelled;
        default:
            return ExitCode::internal;
    }
}

std::string name_of(ErrorKind kind) {
    switch (kind) {
        case ErrorKind::usage:
            return "usage";
        case ErrorKind::bad_input:
            return "bad input";
        case ErrorKind::out_of_resources:
            return "out of resources";
        case ErrorKind::cancelled:
            return "cancelled";
        default:
            return "internal";
    }
}

std::string exit_code_help() {
    return "Exit codes:\n"
           "  0  done\n"
           "  1  internal: a defect of hairbake\n"
           "  2  usage: unknown option or field, value out of range, output folder in use\n"
           "  3  bad input: a file is missing, broken or cannot be read or written\n"
           "  4  out of resources: memory or disk\n"
           "  5  cancelled: SIGINT (Ctrl-C) or SIGTERM; nothing half-written remains\n";
}

Error current_error() {
    try {
        throw;
    } catch (const Error& error) {
        return error;
    } catch (const std::bad_alloc&) {
        return {ErrorKind::out_of_resources, "memory ran out"};
    } catch (const std::system_error& error) {
        const bool full = error.code() == std::errc::no_space_on_device ||
                          error.code() == std::errc::not_enough_memory ||
                          error.code() == std::errc::resource_unavailable_try_again;
        return {full ? ErrorKind::out_of_resources : ErrorKind::bad_input, error.what()};
    } catch (const std::exception& error) {
        return {ErrorKind::internal, error.what()};
    }
}

}  // namespace hairbake
