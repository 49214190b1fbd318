#include "server/jobs/stage_plan.h"

#include <algorithm>

#include "core/base/digest.h"
#include "core/request/request_json.h"
#include "core/request/request_keys.h"

namespace hairbake {
namespace {

std::string digest_in(const std::optional<std::string>& file) {
    return file ? file->substr(std::string("sha256:").size()) : std::string();
}

TransmittanceInputs transmittance_inputs(const BakeRequest& request) {
    return {digest_in(request.hair), digest_in(request.occluder), digest_in(request.receiver)};
}

/// The formats in which this stage writes files. A format is left out only where the stage surely has none of it.
std::vector<std::string> formats_of(const BakeRequest& request, std::initializer_list<const char*> never) {
    std::vector<std::string> formats;
    for (const std::string& format : request.outputs)
        if (std::find(never.begin(), never.end(), format) == never.end()) formats.push_back(format);
    std::sort(formats.begin(), formats.end());
    return formats;
}

void make_key(StagePlan& stage, const BakeRequest& alone) {
    Digest digest;
    digest.add("hairbake stage " + std::to_string(output_format) + "\n" + stage.core_key + "\n");
    for (const std::string& format : alone.outputs) digest.add(format + "\n");
    stage.key = digest.hex();
    stage.request = to_json(alone, -1);
}

StagePlan transmittance_plan(const BakeRequest& request) {
    BakeRequest alone;
    alone.hair = request.hair;
    alone.occluder = request.occluder;
    alone.receiver = request.receiver;
    alone.strand = request.strand;
    alone.transmittance = request.transmittance;
    alone.outputs = formats_of(request, {"exr", "ktx2", "dds"});
    const TransmittanceInputs inputs = transmittance_inputs(request);
    StagePlan stage{"transmittance", {}, transmittance_key(inputs, request), {}, {}};
    for (const std::string& digest : {inputs.hair, inputs.occluder, inputs.receiver})
        if (!digest.empty() && std::find(stage.inputs.begin(), stage.inputs.end(), digest) == stage.inputs.end())
            stage.inputs.push_back(digest);
    make_key(stage, alone);
    return stage;
}

StagePlan irradiance_plan(const BakeRequest& request) {
    BakeRequest alone;
    alone.environment = request.environment;
    alone.environment_settings = request.environment_settings;
    alone.irradiance = request.irradiance;
    alone.outputs = formats_of(request, {"hair", "glb", "vdb"});
    const std::string digest = digest_in(request.environment);
    StagePlan stage{"irradiance", {}, irradiance_key(digest, request), {}, {digest}};
    make_key(stage, alone);
    return stage;
}

}  // namespace

std::vector<const StagePlan*> BakePlan::stages() const {
    std::vector<const StagePlan*> list;
    if (transmittance) list.push_back(&*transmittance);
    if (irradiance) list.push_back(&*irradiance);
    return list;
}

std::string bake_id_of(const BakeRequest& request) {
    return bake_id(request.hair ? transmittance_key(transmittance_inputs(request), request) : "",
                   request.environment ? irradiance_key(digest_in(request.environment), request) : "", request);
}

BakePlan plan_bake(const BakeRequest& request) {
    BakePlan plan;
    plan.request = to_json(request, -1);
    plan.hair = digest_in(request.hair);
    plan.environment = digest_in(request.environment);
    if (request.hair) plan.transmittance = transmittance_plan(request);
    if (request.environment) plan.irradiance = irradiance_plan(request);
    plan.id = bake_id(plan.transmittance ? plan.transmittance->core_key : "",
                      plan.irradiance ? plan.irradiance->core_key : "", request);
    return plan;
}

}  // namespace hairbake
