#include "core/request/stages.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "core/base/digest.h"
#include "core/request/request_fields.h"
#include "core/request/request_presets.h"

namespace hairbake {
namespace {

using Text = std::string_view;

// ---- the table -----------------------------------------------------------------------------------------------------

constexpr Text transmittance_inputs[] = {"hair", "occluder", "receiver"};
constexpr Text transmittance_settings[] = {"strand", "transmittance"};
constexpr Phase transmittance_phases[] = {{"transmittance", 10}, {"reference", 5}};

constexpr Text irradiance_inputs[] = {"environment"};
constexpr Text irradiance_settings[] = {"irradiance", "environment_settings", "fiber"};
constexpr Phase irradiance_phases[] = {{"irradiance", 2}};

constexpr Text effective_inputs[] = {"hair", "occluder", "environment"};
// transmittance.directions decides the method auto and the voxels auto.
constexpr Text effective_settings[] = {"strand",
                                       "transmittance.method",
                                       "transmittance.directions",
                                       "transmittance.voxels",
                                       "transmittance.voxel_size",
                                       "environment_settings",
                                       "irradiance.lights",
                                       "fiber",
                                       "effective_transmittance"};
constexpr Phase effective_phases[] = {{"effective_transmittance", 10}, {"effective_reference", 5}};

constexpr Stage table[] = {
    {"transmittance", 4, transmittance_inputs, transmittance_settings, transmittance_phases,
     [](const BakeRequest& request) { return request.hair.has_value(); }, true, ""},
    {"irradiance", 3, irradiance_inputs, irradiance_settings, irradiance_phases,
     [](const BakeRequest& request) { return request.environment.has_value(); }, true, "irradiance"},
    {"effective_transmittance", 1, effective_inputs, effective_settings, effective_phases,
     [](const BakeRequest& request) { return request.effective_transmittance.enabled; }, false, ""},
};

/// The phase in which each input is read. Meshes are read with the hair that they belong to.
struct InputPhase {
    Text input;
    Phase phase;
};
constexpr InputPhase input_phases[] = {{"hair", {"read_hair", 2}}, {"environment", {"read_environment", 2}}};
constexpr Phase write_phase{"write", 3};
constexpr double tracing_factor = 10;  ///< how much longer the transmittance takes with the method trace

// ---- settings ------------------------------------------------------------------------------------------------------

bool reads(const Stage& stage, const RequestField& field) {
    return std::any_of(stage.settings.begin(), stage.settings.end(),
                       [&](Text read) { return is_or_lies_in(field.path, read); });
}

/// "fiber.kajiya_kay.exponent" is a parameter of the model "kajiya-kay"; other fields are of no model.
bool of_another_model(const RequestField& field, const BakeRequest& request) {
    if (!in_block(field.path, "fiber") || field.path == "fiber.model") return false;
    return !in_block(field.path, "fiber." + std::string(entry_of(request.fiber.model).block));
}

/// Canonical JSON (sorted keys, one line) of the settings that the stage reads, fields at their first places.
std::string settings_text(const Stage& stage, const BakeRequest& request) {
    RequestField::Json object = RequestField::Json::object();
    for (const RequestField& field : request_fields()) {
        if (!reads(stage, field) || of_another_model(field, request)) continue;
        RequestField::Json value = field.get(request);
        if (field.first_value && value == *field.first_value) continue;
        std::string path = field.first_path.empty() ? field.path : field.first_path;
        if (!stage.bare_block.empty() && in_block(path, stage.bare_block)) path.erase(0, stage.bare_block.size() + 1);
        set_at(object, path, std::move(value));
    }
    return nlohmann::json(object).dump();
}

}  // namespace

std::span<const Stage> stages() { return table; }

std::string versions_text() {
    std::string text;
    for (const Stage& stage : table) text += std::string(stage.name) + " " + std::to_string(stage.algorithm) + ", ";
    return text + "output format " + std::to_string(output_format);
}

const Stage* find_stage(std::string_view name) {
    for (const Stage& stage : table)
        if (stage.name == name) return &stage;
    return nullptr;
}

const std::vector<std::string>& formats_of(const Stage& stage) {
    using Lists = std::map<std::string, std::vector<std::string>, std::less<>>;
    static const Lists lists =
        RequestField::Json::parse(request_schema())["properties"]["outputs"]["x-stages"].get<Lists>();
    static const std::vector<std::string> none;
    const auto found = lists.find(stage.name);
    return found == lists.end() ? none : found->second;
}

bool reads_field(const Stage& stage, std::string_view path) {
    const bool is_input = std::find(stage.inputs.begin(), stage.inputs.end(), path) != stage.inputs.end();
    return is_input || std::any_of(stage.settings.begin(), stage.settings.end(),
                                   [&](Text read) { return is_or_lies_in(path, read); });
}

std::vector<const Stage*> stages_of(const BakeRequest& request) {
    std::vector<const Stage*> list;
    for (const Stage& stage : table)
        if (stage.asked_for(request)) list.push_back(&stage);
    return list;
}

std::string stage_key(const Stage& stage, const InputDigests& digests, const BakeRequest& request) {
    Digest digest;
    digest.add("hairbake " + std::string(stage.name) + " " + std::to_string(stage.algorithm) + "\n");
    for (const Text input : stage.inputs) {
        const auto found = digests.find(input);
        digest.add((found == digests.end() ? "" : found->second) + "\n");
    }
    return digest.add(settings_text(stage, request)).hex();
}

std::string bake_id(const StageKeys& keys, const BakeRequest& request) {
    std::vector<std::string> outputs = request.outputs;
    std::sort(outputs.begin(), outputs.end());
    Digest digest;
    digest.add("hairbake bake " + std::to_string(output_format) + "\n");
    const auto key_of = [&](Text name) {
        const auto found = keys.find(name);
        return found == keys.end() ? std::string() : found->second;
    };
    // The first version's two stages have a line each, empty where one does not run. A later stage has a line with its
    // name where it runs, so that bakes without it keep their ids.
    for (const Stage& stage : table) {
        const std::string key = key_of(stage.name);
        if (stage.of_first_version)
            digest.add(key + "\n");
        else if (!key.empty())
            digest.add(std::string(stage.name) + " " + key + "\n");
    }
    for (const std::string& output : outputs) digest.add(output + "\n");
    return digest.hex();
}

BakeRequest request_alone(const Stage& stage, const BakeRequest& request) {
    BakeRequest alone;
    alone.outputs.clear();
    for (const RequestField& field : request_fields()) {
        const bool input = std::find(stage.inputs.begin(), stage.inputs.end(), field.path) != stage.inputs.end();
        if (input || (reads(stage, field) && !of_another_model(field, request))) field.set(alone, field.get(request));
    }
    const std::vector<std::string>& formats = formats_of(stage);
    for (const std::string& format : request.outputs)
        if (std::find(formats.begin(), formats.end(), format) != formats.end()) alone.outputs.push_back(format);
    std::sort(alone.outputs.begin(), alone.outputs.end());
    return alone;
}

std::vector<Phase> planned_phases(std::span<const Stage* const> stages, const BakeRequest& request) {
    std::vector<Phase> phases;
    const auto add = [&](Phase phase) {
        for (const Phase& planned : phases)
            if (planned.name == phase.name) return;
        phases.push_back(phase);
    };
    for (const InputPhase& read : input_phases)
        if (std::any_of(stages.begin(), stages.end(), [&](const Stage* stage) {
                return std::find(stage->inputs.begin(), stage->inputs.end(), read.input) != stage->inputs.end();
            }))
            add(read.phase);
    for (const Stage* stage : stages) {
        for (Phase phase : stage->phases) {
            if (phase.name == "effective_reference" && request.effective_transmittance.reference_neighborhoods == 0)
                continue;
            if (phase.name == "reference" && request.transmittance.reference_vertices == 0) continue;
            if ((phase.name == "transmittance" || phase.name == "effective_transmittance") &&
                request.transmittance.method == TransmittanceMethod::trace)
                phase.share *= tracing_factor;
            add(phase);
        }
    }
    add(write_phase);
    double sum = 0;
    for (const Phase& phase : phases) sum += phase.share;
    for (Phase& phase : phases) phase.share /= sum;
    return phases;
}

double fraction_of_whole(std::span<const Phase> phases, std::string_view name, double fraction) {
    double before = 0;
    for (const Phase& phase : phases) {
        if (phase.name == name) return before + phase.share * std::clamp(fraction, 0.0, 1.0);
        before += phase.share;
    }
    return 0;
}

}  // namespace hairbake
