// Reads a result folder back.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/request/stages.h"
#include "core/result/map_set.h"
#include "core/result/vertex_array.h"

namespace hairbake {

/// The contents of the .npy files of a result, and the request and inputs that they were baked from.
struct StoredResult {
    BakeRequest request;                                ///< as it was run
    InputDigests digests;                               ///< of the inputs
    std::map<std::string, std::string> absolute_paths;  ///< of the inputs when they were baked, as far as it is known
    std::string hair_file_digest;                       ///< of transmittance.hair, where the folder has it; else empty
    std::vector<VertexArray> arrays;                    ///< of array_kinds() that the folder has
    std::optional<MapSet> maps;                         ///< without statistics
};

/// Every file is checked: it has the SHA-256 that the manifest gives, shapes fit each other, values are finite and
/// shares are 0 to 1.
/// Throws Error(bad_input) naming the file, what was found and what is allowed.
StoredResult read_result(const std::filesystem::path& folder);

}  // namespace hairbake
