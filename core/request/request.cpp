#include "core/request/request.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/short_number.h"
#include "core/request/request_presets.h"

namespace hairbake {
namespace {

[[noreturn]] void refuse(const std::string& field, const std::string& found, const std::string& allowed) {
    throw Error(ErrorKind::usage, field + " is " + found + "; allowed is " + allowed, field);
}

/// Both ends belong to the range. A NaN is in no range.
void check_range(const std::string& field, double value, double low, double high) {
    if (!(value >= low && value <= high))
        refuse(field, short_number(value), short_number(low) + " to " + short_number(high));
}

void check_positive(const std::string& field, double value, double high) {
    if (!(value > 0 && value <= high))
        refuse(field, short_number(value), "more than 0 and at most " + short_number(high));
}

void check_choice(const std::string& field, const std::string& value, const std::vector<std::string>& allowed) {
    if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return;
    std::string list;
    for (const std::string& choice : allowed) list += (list.empty() ? "" : ", ") + choice;
    refuse(field, "\"" + value + "\"", "one of " + list);
}

void check_inputs(const BakeRequest& request) {
    if (!request.hair && !request.environment)
        throw Error(ErrorKind::usage,
                    "the request has neither hair nor environment; give hair (--hair) for transmittance, environment "
                    "(--env) for irradiance maps, or both",
                    "hair");
    if (request.hair && request.hair->empty()) refuse("hair", "empty", "a path");
    for (const auto& [field, path] : {std::pair("environment", &request.environment),
                                      {"occluder", &request.occluder},
                                      {"receiver", &request.receiver}})
        if (*path && (*path)->empty()) refuse(field, "empty", "a path");
    for (const auto& [field, path] : {std::pair("occluder", &request.occluder), {"receiver", &request.receiver}})
        if (*path && !request.hair) refuse(field, "given without hair", "a mesh beside a hair model");
}

void check_strand(const StrandSettings& strand) {
    if (strand.width) check_positive("strand.width", *strand.width, 1e18);
    check_positive("strand.width_scale", strand.width_scale, 1e6);
    check_range("strand.opacity", strand.opacity, 0, 1);
    check_range("strand.time", strand.time, -1e9, 1e9);
}

void check_transmittance(const TransmittanceSettings& settings) {
    check_range("transmittance.directions", settings.directions, 1, 4096);
    const int root = static_cast<int>(std::lround(std::sqrt(settings.directions)));
    if (settings.direction_set == DirectionSet::stratified && root * root != settings.directions)
        refuse("transmittance.directions", std::to_string(settings.directions),
               "a square number (1, 4, 9 ... 4096) with the direction set stratified");
    check_range("transmittance.seed", static_cast<double>(settings.seed), 0, 0x1p53 - 1);
    if (settings.voxels) check_range("transmittance.voxels", *settings.voxels, 32, 1024);
    if (settings.voxel_size) check_positive("transmittance.voxel_size", *settings.voxel_size, 1e18);
    check_range("transmittance.sh_bands", settings.sh_bands, 0, 4);
    check_range("transmittance.opacity_maps.layers", settings.opacity_maps.layers, 1, 16);
    check_range("transmittance.opacity_maps.layer_spacing", settings.opacity_maps.layer_spacing, 1, 16);
    check_range("transmittance.opacity_maps.resolution", settings.opacity_maps.resolution, 16, 4096);
    check_range("transmittance.reference_vertices", settings.reference_vertices, 0, 100000);
}

void check_environment(const EnvironmentSettings& settings) {
    for (const double angle : settings.rotation_deg)
        check_range("environment_settings.rotation_deg", angle, -36000, 36000);
    check_range("environment_settings.exposure_stops", settings.exposure_stops, -64, 64);
    for (const double factor : settings.tint) check_range("environment_settings.tint", factor, 0, 1e6);
}

/// Checks the parameters of the chosen model alone.
/// Known before the bake, so said before it.
void check_maps(const BakeRequest& request) {
    if (!request.environment || entry_of(request.fiber.model).has_maps) return;
    std::string allowed;
    for (const FiberModelEntry& entry : fiber_models)
        if (entry.has_maps) allowed += (allowed.empty() ? "" : ", ") + std::string(entry.name);
    refuse("fiber.model", std::string(name_of(request.fiber.model)) + ", which has no irradiance maps yet",
           "one of " + allowed + ", or a request without environment");
}

void check_fiber(const FiberSettings& settings) {
    for (const FiberNumber& number : fiber_numbers)
        if (number.model == settings.model) check_range(path_of(number), number.of(settings), number.low, number.high);
}

void check_light(const std::string& field, const DirectionalLight& light) {
    for (int i = 0; i < 3; ++i) {
        check_range(field + ".direction", light.direction[i], -1e6, 1e6);
        check_range(field + ".irradiance", light.irradiance[i], 0, 1e12);
    }
    if (!(dot(light.direction, light.direction) > 1e-12))
        refuse(field + ".direction", "of no length", "a direction towards the light");
}

void check_irradiance(const IrradianceSettings& settings) {
    check_range("irradiance.face_size", settings.face_size, 4, 256);
    check_range("irradiance.specular_maps", settings.specular_maps, 2, 257);
    if (settings.sh_bands_diffuse) check_range("irradiance.sh_bands.diffuse", *settings.sh_bands_diffuse, 1, 128);
    if (settings.sh_bands_specular) check_range("irradiance.sh_bands.specular", *settings.sh_bands_specular, 1, 128);
    check_positive("irradiance.sh_error", settings.sh_error, 1);
    if (settings.lights.size() > 64)
        refuse("irradiance.lights", std::to_string(settings.lights.size()) + " lights", "at most 64");
    for (std::size_t i = 0; i < settings.lights.size(); ++i)
        check_light("irradiance.lights[" + std::to_string(i) + "]", settings.lights[i]);
}

void check_occluder(const BakeRequest& request) {
    if (request.occluder && request.transmittance.method == TransmittanceMethod::opacity_maps)
        refuse("occluder", "given to the method opacity_maps", "an occluder with the methods auto, volume and trace");
}

void check_effective(const BakeRequest& request) {
    const EffectiveSettings& settings = request.effective_transmittance;
    check_range("effective_transmittance.lights", settings.lights, 1, 1024);
    check_range("effective_transmittance.cosines", settings.cosines, 1, 5);
    check_range("effective_transmittance.reference_neighborhoods", settings.reference_neighborhoods, 0, 100000);
    if (!settings.enabled) return;
    const std::string field = "effective_transmittance.enabled";
    if (!request.hair || !request.environment)
        refuse(field, std::string("true without ") + (request.hair ? "environment" : "hair"),
               "true with both hair and environment");
    if (request.transmittance.method == TransmittanceMethod::opacity_maps)
        refuse(field, "true with the transmittance.method opacity_maps",
               "true with the methods auto, volume and trace");
}

void check_outputs(const BakeRequest& request) {
    const std::vector<std::string>& outputs = request.outputs;
    for (auto output = outputs.begin(); output != outputs.end(); ++output) {
        check_choice("outputs", *output, output_formats());
        if (std::find(outputs.begin(), output, *output) != output) refuse("outputs", *output + " twice", "each once");
    }
    // This is known before the bake, so it is refused here.
    if (request.hair && request.wants("vdb") && request.transmittance.method == TransmittanceMethod::opacity_maps)
        refuse("outputs", "vdb with the method opacity_maps, which has no density grid",
               "vdb with the methods auto, volume and trace");
}

}  // namespace

bool BakeRequest::wants(const std::string& format) const {
    return std::find(outputs.begin(), outputs.end(), format) != outputs.end();
}

const std::vector<std::string>& output_formats() {
    static const auto formats = nlohmann::json::parse(request_schema())["properties"]["outputs"]["items"]["enum"]
                                    .get<std::vector<std::string>>();
    return formats;
}

void validate(const BakeRequest& request) {
    check_inputs(request);
    check_strand(request.strand);
    check_transmittance(request.transmittance);
    check_environment(request.environment_settings);
    check_fiber(request.fiber);
    check_maps(request);
    check_irradiance(request.irradiance);
    check_occluder(request);
    check_effective(request);
    check_outputs(request);
}

}  // namespace hairbake
