#include "core/request/unused_fields.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/request/request_fields.h"
#include "core/request/stages.h"

namespace hairbake {
namespace {

/// Fields that one method reads: the field or block, whether a request uses it, and the reason where it does not.
struct Condition {
    std::string_view path;
    bool (*is_used)(const BakeRequest&);
    std::string_view reason;
};

/// `auto` may sweep; density.vdb has a grid with every method that writes it.
bool may_make_a_grid(const BakeRequest& request) {
    const TransmittanceMethod method = request.transmittance.method;
    return method == TransmittanceMethod::automatic || method == TransmittanceMethod::volume || request.wants("vdb");
}

bool is_sh(const BakeRequest& request) { return request.irradiance.method == IrradianceMethod::sh; }

constexpr std::array conditions{
    Condition{"transmittance.voxels", may_make_a_grid, "transmittance.method needs no voxels"},
    Condition{"transmittance.voxel_size", may_make_a_grid, "transmittance.method needs no voxels"},
    Condition{
        "transmittance.opacity_maps",
        [](const BakeRequest& request) { return request.transmittance.method == TransmittanceMethod::opacity_maps; },
        "transmittance.method is not opacity_maps"},
    Condition{"irradiance.sh_bands", is_sh, "irradiance.method is exact; the bands are those of the method sh"},
    Condition{"irradiance.sh_error", is_sh, "irradiance.method is exact; it is the aim of the method sh"},
    Condition{"irradiance.clamp_negative", is_sh, "irradiance.method is exact, which makes no negative texels"},
};

/// Why the stage does not run.
std::string why_not(const Stage& stage, const BakeRequest& request) {
    if (!request.hair && stage.inputs.front() == "hair") return "there is no hair";
    if (!request.environment && stage.inputs.front() == "environment") return "there is no environment";
    return std::string(stage.name) + ".enabled is false";
}

bool writes(const Stage& stage, const std::string& format) {
    const std::vector<std::string>& formats = formats_of(stage);
    return std::find(formats.begin(), formats.end(), format) != formats.end();
}

}  // namespace

std::string why_unused(const BakeRequest& request, const std::string& given) {
    const RequestField* field = find_field(given);
    if (!field) return {};
    std::vector<const Stage*> readers;
    for (const Stage& stage : stages())
        if (reads_field(stage, field->path)) readers.push_back(&stage);
    const auto runs = [&](const Stage* stage) { return stage->asked_for(request); };
    if (field->path == "effective_transmittance.enabled") return {};  // it says itself whether it is used
    if (!readers.empty() && std::none_of(readers.begin(), readers.end(), runs))
        return why_not(*readers[0], request) + ", and so there is no stage " + std::string(readers[0]->name);
    for (const Condition& condition : conditions)
        if (is_or_lies_in(field->path, condition.path) && !condition.is_used(request))
            return std::string(condition.reason);
    return {};
}

std::vector<std::string> request_warnings(const BakeRequest& request) {
    std::vector<std::string> warnings;
    if (request.transmittance.voxels && request.transmittance.voxel_size)
        warnings.emplace_back("transmittance.voxels is not used: transmittance.voxel_size is given");
    if (request.outputs == BakeRequest().outputs) return warnings;
    const std::vector<const Stage*> running = stages_of(request);
    for (const std::string& format : request.outputs) {
        if (std::any_of(running.begin(), running.end(), [&](const Stage* stage) { return writes(*stage, format); }))
            continue;
        const auto writer =
            std::find_if(stages().begin(), stages().end(), [&](const Stage& stage) { return writes(stage, format); });
        if (writer != stages().end())
            warnings.push_back("no file of the output " + format + " is written: it is of the stage " +
                               std::string(writer->name) + ", and " + why_not(*writer, request));
    }
    return warnings;
}

}  // namespace hairbake
