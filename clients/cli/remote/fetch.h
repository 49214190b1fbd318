// A result from the server as a folder that appears whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "clients/cli/remote/server.h"

namespace hairbake {

struct Fetched {
    std::size_t files = 0;
    std::uint64_t bytes = 0, received = 0;  ///< of the folder; of these over the wire
};

/// Fetches the files of the bake `id` into `folder`: new, empty or an earlier result, whose files of the same digest
/// are not fetched again. What is there so far lies in a hidden folder beside it, by digest, and the next fetch into
/// the same folder goes on there. Every file is checked against the manifest's digest, the manifest against its ETag.
/// Reports the stage "fetch". Throws Error(usage) when `folder` may not be written or another fetch is at it,
/// Error(out_of_resources) when the disk has no room, RemoteError.
Fetched fetch_result(Server& server, const std::string& id, const std::filesystem::path& folder);

}  // namespace hairbake
