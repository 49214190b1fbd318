// What a command does with bakes once they are on the server: waits, fetches, tells how it ended.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "clients/cli/remote/connection_flags.h"
#include "clients/cli/remote/wait.h"

namespace hairbake {

struct Awaited {
    std::function<std::vector<EndedBake>(Server&)> wait;
    std::string which;  ///< arguments of `hairbake wait` that mean the same bakes
    /// Folder of a bake's result; empty: it is not fetched.
    std::function<std::string(const std::string& id)> folder = [](const std::string&) { return ""; };
    /// Puts words for people into a message.
    std::function<std::string(std::string)> words = [](std::string text) { return text; };
    std::string remark;  ///< appended to the line of a done bake
};

/// Waits and fetches; prints one line for each bake that is done (JSON lines with --progress json). Throws
/// RemoteError(bake_failed) or RemoteError(bake_cancelled) when not all are. When it is interrupted, the bakes go on on
/// the server, and it says how to go on here and how to cancel them.
void await_bakes(const ConnectionFlags& flags, const ServerOptions& options, const Awaited& awaited);

/// A line on standard output, at once.
void print_line(const std::string& line);

/// "3.2 MB".
std::string in_megabytes(std::uint64_t bytes);

}  // namespace hairbake
