// The facade: one call that bakes. Clients and server see core through this header.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "core/base/progress.h"
#include "core/hair/hair_model.h"
#include "core/irradiance/irradiance_maps.h"
#include "core/reference/error_bar.h"
#include "core/request.h"
#include "core/volume/transmittance.h"

namespace hairbake {

struct BakeResult {
    BakeRequest request;   ///< as run
    std::optional<HairModel> hair;
    std::optional<Transmittance> transmittance;
    std::optional<ErrorBar> error_bar;
    std::optional<EnvironmentMap> environment;   ///< pixels dropped, facts kept
    std::optional<IrradianceMaps> irradiance;

    std::string hair_digest, environment_digest;         ///< SHA-256 of the input files, empty when not given
    std::string transmittance_key, irradiance_key;       ///< stage keys: digest of exactly what the stage reads
    std::uint64_t segments = 0, degenerate_segments = 0;
    std::map<std::string, double> timings_s;             ///< read_hair, transmittance, reference, read_environment, irradiance, write
    std::uint64_t peak_memory_bytes = 0;
};

/// Runs both stages of `request` on `threads` threads (0: one per core). Validates first.
/// Throws Error; nothing is written to disk.
BakeResult bake(const BakeRequest& request, int threads, Progress& progress);

}  // namespace hairbake
