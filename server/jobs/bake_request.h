// The body of a request for a bake, as it comes over HTTP.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/jobs/stage_plan.h"

namespace hairbake {

class Sql;

struct AskedBake {
    BakeRequest request;  ///< files are "sha256:..."
    std::string names;    ///< as in BakePlan
    int priority = 0;
    std::vector<std::string> warnings;  ///< of fields that the client named by deprecated places
};

/// Reads a request: fills in defaults and replaces names by digests, in the caller's transaction.
///
/// `text` is JSON of config/request.schema.json, plus "priority" from -10 to 10. A file is sha256:... or name:...
/// `changes` is JSON of the same form; its fields replace those of `text`, which is then a stored request.
/// Throws Refusal naming the field; a path is refused, too.
AskedBake read_bake_request(Sql& sql, const std::string& text, const std::optional<std::string>& changes = {});

/// Names of the request's blocks that a rebake may change: those that only stages with an environment read.
std::vector<std::string> lighting_blocks();

/// Throws Refusal naming the field whose file is not stored, unless all stages that read it are stored.
BakePlan plan_bake(Sql& sql, const AskedBake& asked);

/// Whether the stage's result is stored, so that nothing is computed for it.
bool is_stored(Sql& sql, const StagePlan& stage);

/// The digest that `value`, "sha256:..." or "name:...", stands for. `kind` is the kind of names.
/// Throws Refusal naming `field`.
std::string named_digest(Sql& sql, const std::string& value, const std::string& kind, const std::string& field);

}  // namespace hairbake
