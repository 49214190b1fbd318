// The work of a command on bakes that are on the server: waits for them, fetches them, reports how they ended.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "clients/cli/remote/connection_flags.h"
#include "clients/cli/remote/wait.h"
#include "core/bake.h"

namespace hairbake {

struct Awaited {
    std::function<std::vector<EndedBake>(Server&)> wait;
    std::string which;  ///< arguments of `hairbake wait` that mean the same bakes
    /// Folder of a bake's result; empty: it is not fetched.
    std::function<std::string(const std::string& id)> folder = [](const std::string&) { return ""; };
    /// Replaces parts of a message by words for the user, e.g. digests by paths.
    std::function<std::string(std::string)> words = [](std::string text) { return text; };
    std::string remark;                ///< appended to the line of a done bake
    std::vector<NamedInput> inputs{};  ///< must not lie in a folder of a result
};

/// Waits and fetches; prints one line for each bake that is done (JSON lines with --progress json). On an
/// interrupt the bakes continue on the server; a message says how to resume the wait and how to cancel them.
/// Throws RemoteError(bake_failed) or RemoteError(bake_cancelled) when some are not done.
void await_bakes(const ConnectionFlags& flags, const ServerOptions& options, const Awaited& awaited);

/// "3.2 MB".
std::string in_megabytes(std::uint64_t bytes);

}  // namespace hairbake
