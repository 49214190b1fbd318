// Reads a result folder back.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/irradiance/irradiance_maps.h"
#include "core/request/request.h"

namespace hairbake {

/// What the .npy files of a result hold, and what they were baked from.
struct StoredResult {
    BakeRequest request;                                           ///< as it was run
    std::string hair_digest, environment_digest, occluder_digest;  ///< SHA-256 of the inputs, or empty
    std::string hair_file_digest;                                  ///< of transmittance.hair, where the folder has it
    std::vector<float> average;                                    ///< [V], A; empty without transmittance
    std::vector<float> sh;               ///< [V * bands^2], with request.transmittance.sh_bands
    std::vector<float> bent_cone;        ///< [V * 4], with request.transmittance.bent_cone
    std::optional<IrradianceMaps> maps;  ///< texels, face size and exponent; no statistics
};

/// Trusts nothing: every file is the one whose SHA-256 the manifest gives, shapes fit each other, values are finite and
/// A is 0 to 1. Throws Error(bad_input) naming the file, what was found and what is allowed.
StoredResult read_result(const std::filesystem::path& folder);

}  // namespace hairbake
