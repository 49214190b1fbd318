// The flags of every command that talks to a service, and what such commands share.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "clients/cli/progress_display.h"
#include "clients/cli/remote/server.h"

namespace CLI {
class App;
}

namespace hairbake {

struct ConnectionFlags {
    std::string server, token_file, ca_file, progress = "auto";
    double patience_s = 120;

    bool json() const { return progress == "json"; }
};

/// Adds the flags and the help about exit codes; `flags` must live as long as `command` parses.
void add_connection_flags(CLI::App& command, ConnectionFlags& flags);

/// Checks the address and reads the token. Warns of a token file that everybody can read and of a token that would go
/// over the network in the clear. Throws Error(usage), Error(bad_input).
ServerOptions server_options(const ConnectionFlags& flags);

/// Runs `work` against the server with a progress display of these stages, which is gone when this returns. Throws what
/// `work` throws; an answer of an unexpected shape is RemoteError(refused).
void run_phase(const ConnectionFlags& flags, const ServerOptions& options, const std::vector<Phase>& phases,
               const std::function<void(Server&)>& work);

/// Throws Error(usage) unless all are ids.
void check_ids(const std::vector<std::string>& ids, const char* field);

/// The same for ids, or one batch's, of which exactly one must be given to `command`.
void check_ids_or_batch(const std::vector<std::string>& ids, const std::string& batch, const std::string& command);

}  // namespace hairbake
