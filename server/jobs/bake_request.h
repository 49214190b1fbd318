// The body of a request for a bake, as it comes over HTTP.
#pragma once

#include <string>

#include "server/jobs/stage_plan.h"
#include "server/store/database.h"

namespace hairbake {

struct AskedBake {
    BakeRequest request;  ///< files are "sha256:..."
    std::string names;    ///< as in BakePlan
    int priority = 0;
};

/// Reads the request's JSON (config/request.schema.json, plus "priority" from -10 to 10): defaults are filled in, names
/// become digests. A path is refused. In the caller's transaction. Throws Refusal naming the field.
AskedBake read_bake_request(Sql& sql, const std::string& text);

/// Throws Refusal naming the field whose file a stage needs that is not stored, when the file is not stored either.
BakePlan plan_bake(Sql& sql, const AskedBake& asked);

/// Whether the stage's result is stored, so that nothing is computed for it.
bool is_stored(Sql& sql, const StagePlan& stage);

/// The digest that "sha256:..." or "name:..." stands for; `kind` is that of names. Throws Refusal naming `field`.
std::string named_digest(Sql& sql, const std::string& value, const std::string& kind, const std::string& field);

}  // namespace hairbake
