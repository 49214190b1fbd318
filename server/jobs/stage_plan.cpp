#include "server/jobs/stage_plan.h"

#include <algorithm>

#include "core/base/assert.h"
#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/request/request_json.h"
#include "core/request/stages.h"

namespace hairbake {
namespace {

/// Digests of the request's files, by the fields that name them.
InputDigests digests_of(const BakeRequest& request) {
    InputDigests digests;
    for (const FileField& field : file_fields())
        if (const auto& file = request.*field.value) {
            HAIRBAKE_ASSERT(file->starts_with("sha256:"));
            digests[field.name] = file->substr(std::string_view("sha256:").size());
        }
    return digests;
}

std::string digest_in(const InputDigests& digests, std::string_view field) {
    const auto found = digests.find(field);
    return found == digests.end() ? std::string() : found->second;
}

/// The id of the stage's result in the store: the core's key, and the formats in which the stage writes files.
std::string store_key(const std::string& core_key, const BakeRequest& alone) {
    Digest digest;
    digest.add("hairbake stage " + std::to_string(output_format) + "\n" + core_key + "\n");
    for (const std::string& format : alone.outputs) digest.add(format + "\n");
    return digest.hex();
}

StagePlan plan_stage(const Stage& stage, const InputDigests& digests, const BakeRequest& request) {
    const BakeRequest alone = request_alone(stage, request);
    StagePlan plan;
    plan.kind = stage.name;
    plan.core_key = stage_key(stage, digests, request);
    plan.key = store_key(plan.core_key, alone);
    plan.request = to_json(alone, -1);
    for (const std::string_view input : stage.inputs) {
        const std::string digest = digest_in(digests, input);
        if (!digest.empty() && !std::count(plan.inputs.begin(), plan.inputs.end(), digest))
            plan.inputs.push_back(digest);
    }
    return plan;
}

StageKeys keys_of(const InputDigests& digests, const BakeRequest& request) {
    StageKeys keys;
    for (const Stage* stage : stages_of(request)) keys[std::string(stage->name)] = stage_key(*stage, digests, request);
    return keys;
}

}  // namespace

std::span<const FileField> file_fields() {
    static constexpr FileField fields[] = {{"hair", "model", &BakeRequest::hair},
                                           {"environment", "environment", &BakeRequest::environment},
                                           {"occluder", "mesh", &BakeRequest::occluder},
                                           {"receiver", "mesh", &BakeRequest::receiver}};
    return fields;
}

std::string bake_id_of(const BakeRequest& request) { return bake_id(keys_of(digests_of(request), request), request); }

BakePlan plan_bake(const BakeRequest& request) {
    const InputDigests digests = digests_of(request);
    BakePlan plan;
    plan.id = bake_id(keys_of(digests, request), request);
    plan.request = to_json(request, -1);
    plan.hair = digest_in(digests, "hair");
    plan.environment = digest_in(digests, "environment");
    for (const Stage* stage : stages_of(request)) plan.stages.push_back(plan_stage(*stage, digests, request));
    return plan;
}

std::optional<StagePlan> plan_stage_again(const std::string& kind, const std::string& request) try {
    const Stage* const stage = find_stage(kind);
    if (!stage) return std::nullopt;
    BakeRequest alone;
    merge_json(alone, request, "the stage's request");
    return plan_stage(*stage, digests_of(alone), alone);
} catch (const Error&) {
    return std::nullopt;
}

}  // namespace hairbake
