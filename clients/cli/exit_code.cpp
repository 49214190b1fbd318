#include "clients/cli/exit_code.h"

#include <filesystem>
#include <new>
#include <system_error>

#include "clients/cli/output.h"
#include "clients/cli/progress_display.h"

namespace hairbake {
namespace {

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

ExitCode exit_code(const std::error_code& error) {
    const bool full = error == std::errc::no_space_on_device || error == std::errc::not_enough_memory ||
                      error == std::errc::resource_unavailable_try_again;
    return full ? ExitCode::out_of_resources : ExitCode::bad_input;
}

/// A failure of the output itself changes nothing: the failure that it should tell of goes to standard error too.
void tell_failure(const Failure& failure) {
    try {
        print_line(R"({"event":"error","kind":)" + json_string(name_of(failure.code)) + R"(,"field":)" +
                   json_string(failure.field) + R"(,"message":)" + json_string(failure.message) + "}");
    } catch (const Error&) {
    }
}

}  // namespace

std::string name_of(ExitCode code) {
    switch (code) {
        case ExitCode::ok:
            return "done";
        case ExitCode::usage:
            return "usage";
        case ExitCode::bad_input:
            return "bad input";
        case ExitCode::out_of_resources:
            return "out of resources";
        case ExitCode::cancelled:
            return "cancelled";
        case ExitCode::unreachable:
            return "server unreachable";
        case ExitCode::refused:
            return "refused";
        case ExitCode::bake_failed:
            return "bake failed";
        case ExitCode::bake_cancelled:
            return "bake cancelled";
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
           "  5  cancelled: SIGINT (Ctrl-C), SIGTERM or SIGHUP; nothing half-written remains\n";
}

std::string remote_exit_code_help() {
    return exit_code_help() +
           "  6  server unreachable: no answer within --patience, or its certificate is not trusted\n"
           "  7  refused: the server refuses, or its answer cannot be trusted\n"
           "  8  bake failed on the server; the message is the reason\n"
           "  9  bake cancelled: somebody cancelled it on the server\n"
           "After 5 a bake continues on the server. Files sent or fetched so far are kept: the same command resumes.\n";
}

Failure current_failure() {
    try {
        throw;
    } catch (const RemoteError& error) {
        return {error.code(), error.what(), error.field()};
    } catch (const Error& error) {
        return {exit_code(error.kind()), error.what(), error.field()};
    } catch (const std::bad_alloc&) {
        return {ExitCode::out_of_resources, "memory ran out", ""};
    } catch (const std::filesystem::filesystem_error& error) {
        return {exit_code(error.code()), error.path1().string() + ": " + error.code().message(), ""};
    } catch (const std::system_error& error) {
        return {exit_code(error.code()), error.what(), ""};
    } catch (const std::exception& error) {
        return {ExitCode::internal, error.what(), ""};
    }
}

void with_json_failures(const std::string& progress_mode, const std::function<void()>& work) {
    try {
        work();
    } catch (...) {
        if (progress_mode == "json") tell_failure(current_failure());
        throw;
    }
}

}  // namespace hairbake
