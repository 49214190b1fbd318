#include "server/jobs/stage_plan.h"

#include <algorithm>

#include "core/base/digest.h"
#include "core/request/request_json.h"
#include "core/request/stages.h"

namespace hairbake {
namespace {

std::string digest_in(const std::optional<std::string>& file) {
    return file ? file->substr(std::string("sha256:").size()) : std::string();
}

InputDigests digests_of(const BakeRequest& request) {
    InputDigests digests;
    const std::pair<const char*, const std::optional<std::string>*> fields[] = {{"hair", &request.hair},
                                                                                {"environment", &request.environment},
                                                                                {"occluder", &request.occluder},
                                                                                {"receiver", &request.receiver}};
    for (const auto& [field, file] : fields)
        if (*file) digests[field] = digest_in(*file);
    return digests;
}

StagePlan plan_stage(const Stage& stage, const BakeRequest& request) {
    const InputDigests digests = digests_of(request);
    StagePlan plan{std::string(stage.name), {}, stage_key(stage, digests, request), {}, {}};
    for (const std::string_view input : stage.inputs)
        if (const auto found = digests.find(input); found != digests.end())
            if (std::find(plan.inputs.begin(), plan.inputs.end(), found->second) == plan.inputs.end())
                plan.inputs.push_back(found->second);
    const BakeRequest alone = request_alone(stage, request);
    Digest digest;
    digest.add("hairbake stage " + std::to_string(output_format) + "\n" + plan.core_key + "\n");
    for (const std::string& format : alone.outputs) digest.add(format + "\n");
    plan.key = digest.hex();
    plan.request = to_json(alone, -1);
    return plan;
}

}  // namespace

std::vector<const StagePlan*> BakePlan::stages() const {
    std::vector<const StagePlan*> list;
    if (transmittance) list.push_back(&*transmittance);
    if (irradiance) list.push_back(&*irradiance);
    return list;
}

std::string bake_id_of(const BakeRequest& request) { return plan_bake(request).id; }

BakePlan plan_bake(const BakeRequest& request) {
    BakePlan plan;
    plan.request = to_json(request, -1);
    plan.hair = digest_in(request.hair);
    plan.environment = digest_in(request.environment);
    StageKeys keys;
    for (const Stage* stage : stages_of(request)) {
        StagePlan made = plan_stage(*stage, request);
        keys[made.kind] = made.core_key;
        (made.kind == "transmittance" ? plan.transmittance : plan.irradiance) = std::move(made);
    }
    plan.id = bake_id(keys, request);
    return plan;
}

}  // namespace hairbake
