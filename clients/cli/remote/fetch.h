// A result from the server as a folder that appears whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "clients/cli/remote/server.h"

namespace hairbake {

struct Fetched {
    std::size_t files = 0;
    std::uint64_t bytes = 0, received = 0;  ///< of the folder; of these received by this fetch
    std::vector<std::string> warnings;      ///< of the bake's stages
};

/// Fetches the files of the bake `id` into `folder`: new, empty or an earlier result, whose files of the same digest
/// are not fetched again. Files received so far are kept by digest in a hidden folder beside it; the next fetch into
/// the same folder resumes there. Every file is checked against the manifest's digest, the manifest against its ETag.
/// Reports the phase "fetch".
/// Throws Error(usage) when `folder` may not be written or another fetch writes it.
/// Throws Error(out_of_resources) when the disk has no room.
/// Throws RemoteError.
Fetched fetch_result(Server& server, const std::string& id, const std::filesystem::path& folder);

}  // namespace hairbake
