// The plan of a bake: its stages and their keys.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/request/request.h"

namespace hairbake {

/// One unit of work.
struct StagePlan {
    std::string kind;                 ///< the stage's name in the stage table
    std::string key;                  ///< digest of core_key and the formats that the stage writes; its id in the store
    std::string core_key;             ///< the core's key of the stage; a worker's manifest must name the same
    std::string request;              ///< JSON of the request that runs this stage alone; files are "sha256:..."
    std::vector<std::string> inputs;  ///< digests
};

struct BakePlan {
    std::string id;       ///< bake_id()
    std::string request;  ///< JSON, every field, files as "sha256:..."
    std::string names =
        "{}";  ///< JSON: {"environment": {"path": "stage1/sunset", "version": 3}} of what was asked by name
    std::string hair, environment;  ///< digests or empty
    std::vector<StagePlan> stages;  ///< in the order of the stage table
    int priority = 0;
};

/// A field of the request that names a file.
struct FileField {
    const char* name;
    const char* kind;  ///< of the names that it may be asked by: "model", "environment", "mesh"
    std::optional<std::string> BakeRequest::*value;
};

std::span<const FileField> file_fields();

/// `request` is valid and its files are "sha256:<digest>".
std::string bake_id_of(const BakeRequest& request);
BakePlan plan_bake(const BakeRequest& request);

/// The plan that this version of hairbake makes of a stored stage: `kind` and `request` as in StagePlan. Nothing for a
/// stage or a request that this version does not know.
std::optional<StagePlan> plan_stage_again(const std::string& kind, const std::string& request);

}  // namespace hairbake
