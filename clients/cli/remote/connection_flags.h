// The flags and checks of the commands that talk to a service.
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
/// over the network in the clear.
/// Throws Error(usage) for a wrong address.
/// Throws Error(bad_input) for a token file that cannot be read or is not a token.
ServerOptions server_options(const ConnectionFlags& flags);

/// Runs `work` with the server and a progress display of `phases`, which ends when this returns.
/// Throws the errors of `work`.
/// Throws RemoteError(refused) for an answer of an unexpected shape.
void run_phase(const ConnectionFlags& flags, const ServerOptions& options, const std::vector<Phase>& phases,
               const std::function<void(Server&)>& work);

/// Checks that all of `ids` have the form of ids.
/// Throws Error(usage) otherwise.
void check_ids(const std::vector<std::string>& ids, const char* field);

/// Checks that `command` has either ids or a batch, and their form.
/// Throws Error(usage) otherwise.
void check_ids_or_batch(const std::vector<std::string>& ids, const std::string& batch, const std::string& command);

}  // namespace hairbake
