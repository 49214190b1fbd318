// Waits for bakes: polls them until they have ended.
#pragma once

#include <string>
#include <vector>

#include "clients/cli/remote/server.h"

namespace hairbake {

struct EndedBake {
    std::string id, state;       ///< "done", "failed" or "cancelled"
    std::string message, field;  ///< why it failed
};

/// Waits until all bakes have ended. Reports the phase "bake". Survives a restart of the server (Server::ask).
/// Throws RemoteError(refused) for an unknown bake.
std::vector<EndedBake> wait_for_bakes(Server& server, const std::vector<std::string>& ids);
std::vector<EndedBake> wait_for_batch(Server& server, const std::string& batch);

/// Ids of the batch's bakes in one state; all of them when `state` is empty.
std::vector<std::string> bakes_of_batch(Server& server, const std::string& batch, const std::string& state);

}  // namespace hairbake
