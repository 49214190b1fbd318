// A bake taken apart into its stages.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/request/request.h"

namespace hairbake {

/// One unit of work.
struct StagePlan {
    std::string kind;      ///< "transmittance" or "irradiance"
    std::string key;       ///< digest of core_key and the formats that the stage writes: what the store knows it by
    std::string core_key;  ///< transmittance_key() or irradiance_key(); a worker's manifest must name the same
    std::string request;   ///< JSON of the request that runs this stage alone; files are "sha256:..."
    std::vector<std::string> inputs;  ///< digests
};

struct BakePlan {
    std::string id;       ///< bake_id()
    std::string request;  ///< JSON, every field, files as "sha256:..."
    std::string names =
        "{}";  ///< JSON: {"environment": {"path": "stage1/sunset", "version": 3}} of what was asked by name
    std::string hair, environment;  ///< digests or empty
    std::optional<StagePlan> transmittance, irradiance;
    int priority = 0;

    std::vector<const StagePlan*> stages() const;
};

/// `request` is valid and its files are "sha256:<digest>".
std::string bake_id_of(const BakeRequest& request);
BakePlan plan_bake(const BakeRequest& request);

}  // namespace hairbake
