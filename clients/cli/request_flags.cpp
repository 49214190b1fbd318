#include "clients/cli/request_flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <utility>

#include "clients/cli/messages.h"
#include "clients/cli/option_values.h"
#include "core/bake.h"
#include "core/request/field_facts.h"
#include "core/request/request_json.h"
#include "core/request/request_presets.h"
#include "core/request/unused_fields.h"

namespace hairbake {
namespace {

/// A flag and the request field that it sets.
struct FieldFlag {
    const char* flag;
    std::vector<const char*> paths;
    const char* help;
};

const std::vector<FieldFlag>& field_flags() {
    static const std::vector<FieldFlag> flags{
        {"--directions", {"transmittance.directions"}, "directions of the transmittance"},
        {"--voxels", {"transmittance.voxels"}, "voxels on the longest axis"},
        {"--transmittance-method", {"transmittance.method"}, "how the transmittance is computed"},
        {"--width", {"strand.width"}, "strand diameter, instead of the file's"},
        {"--opacity", {"strand.opacity"}, "share of light that one crossing stops"},
        {"--specular-maps", {"irradiance.specular_maps"}, "number of specular maps"},
        {"--exponent", {"fiber.kajiya_kay.exponent"}, "Kajiya-Kay exponent"},
        {"--face-size", {"irradiance.face_size"}, "texels per edge of a cube face"},
        {"--method", {"irradiance.method"}, "how the irradiance is computed"},
        {"--sh-bands", {"irradiance.sh_bands.diffuse", "irradiance.sh_bands.specular"}, "bands of the method sh"},
        {"--layout", {"environment_settings.layout"}, "of the environment"},
        {"--latlong", {"environment_settings.latlong"}, "where the centre column of a lat-long environment looks"},
        {"--rotation", {"environment_settings.rotation_deg"}, "turns the environment about X, then Y, then Z: X,Y,Z"},
        {"--exposure", {"environment_settings.exposure_stops"}, "of the environment"},
        {"--invalid-radiance", {"environment_settings.invalid_radiance"}, "negative, infinite and NaN pixels"},
        {"--outputs", {"outputs"}, "formats of the result, with commas"},
    };
    return flags;
}

std::string text_of(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(ErrorKind::bad_input, file + ": " + std::generic_category().message(errno), "request");
    constexpr std::size_t most = 1 << 20;
    std::string text(most + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    if (stream.bad())
        throw Error(ErrorKind::bad_input, file + ": " + std::generic_category().message(errno), "request");
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > most) throw Error(ErrorKind::usage, file + " is too long; allowed are 1 MiB", "request");
    return text;
}

/// "path=value" of --set.
std::pair<std::string, std::string> split_setting(const std::string& setting) {
    const std::size_t sign = setting.find('=');
    if (sign == std::string::npos || sign == 0)
        throw Error(ErrorKind::usage, "--set " + setting + " is not of the form path=value", "set");
    return {setting.substr(0, sign), setting.substr(sign + 1)};
}

/// Warns of flags and settings without effect; a later setting may have chosen the method that does not read them.
void warn_of_unused(const RequestFlags& flags, const BakeRequest& request) {
    const auto warn = [&](const std::string& name, const std::string& path) {
        if (const std::string reason = why_unused(request, path); !reason.empty())
            say_warning(name + " is not used: " + reason);
    };
    for (const FieldFlag& flag : field_flags())
        if (flags.fields.contains(flag.flag)) warn(flag.flag, flag.paths[0]);
    for (const std::string& setting : flags.settings) warn("--set " + setting, split_setting(setting).first);
    say_warnings(request_warnings(request));
}

/// Runs `body`. Errors about a field that a flag gave begin with the flag.
template <class Body>
void naming_flags(const RequestFlags& flags, const Body& body) try {
    body();
} catch (const Error& error) {
    for (const FieldFlag& flag : field_flags())
        for (const std::string path : flag.paths)
            if (flags.fields.contains(flag.flag) && error.field().starts_with(path))
                throw Error(error.kind(), std::string(flag.flag) + ": " + error.what(), error.field());
    throw;
}

}  // namespace

void add_request_flags(CLI::App& command, RequestFlags& flags, const std::string& environment_help) {
    command.add_option("--env", flags.environment, environment_help)->type_name("FILE");
    command.add_option("--occluder", flags.occluder, "mesh that stops light completely: the head")->type_name("FILE");
    command.add_option("--receiver", flags.receiver, "mesh on which the hair's shadow is baked too")->type_name("FILE");
    command.add_option("--preset", flags.preset, "default, draft, final, paper or v1 (see hairbake presets)")
        ->check(offering(preset_names()))
        ->type_name("NAME")
        ->default_str(std::string(default_preset));
    command.add_option("--request", flags.request_file, "JSON file with fields of the request")->type_name("FILE");
    for (const FieldFlag& flag : field_flags()) {
        const FieldFacts facts = facts_of_field(flag.paths[0]);
        command
            .add_option_function<std::string>(
                flag.flag, [&flags, name = flag.flag](const std::string& value) { flags.fields[name] = value; },
                flag.help + ("; " + range_text(facts)))
            ->check(offering(facts.words))
            ->type_name(facts.is_list ? "LIST" : "VALUE");
    }
    command.add_option("--set", flags.settings, "any field by its path, e.g. transmittance.seed=2 (listed below)")
        ->check(offering(field_paths()))
        ->type_name("PATH=VALUE")
        ->allow_extra_args(false);
}

std::vector<std::string> preset_names() {
    std::vector<std::string> names{std::string(default_preset)};
    for (const Preset& preset : presets()) names.emplace_back(preset.name);
    return names;
}

std::string fields_help() {
    std::string text = "Fields for --set, with unit, allowed values and default:\n";
    for (const FieldFacts& facts : field_facts()) {
        std::string row = "  " + facts.path;
        row.resize(std::max<std::size_t>(row.size() + 2, 42), ' ');
        text += row + range_text(facts) + "\n";
    }
    return text +
           "A number may be written as .5, 1. or +5; a list with commas. \"hairbake presets --schema\" describes "
           "the fields.\n";
}

std::string request_flags_help() {
    return fields_help() + "Later wins: defaults, --preset, --request, flags, --set.\n";
}

void set_fields(BakeRequest& request, const std::vector<std::string>& settings) {
    for (const std::string& setting : settings) {
        const auto [path, value] = split_setting(setting);
        say_warnings(set_field(request, path, value));
    }
}

void check_request_file(const RequestFlags& flags, const std::string& folder) {
    if (flags.request_file) check_outside(folder, std::vector{NamedInput{"--request", *flags.request_file}});
}

BakeRequest make_request(const RequestFlags& flags) {
    BakeRequest request;
    if (flags.preset) apply_preset(request, *flags.preset);
    if (flags.request_file) say_warnings(merge_json(request, text_of(*flags.request_file), *flags.request_file));
    if (flags.hair) request.hair = flags.hair;
    if (flags.environment) request.environment = flags.environment;
    if (flags.occluder) request.occluder = flags.occluder;
    if (flags.receiver) request.receiver = flags.receiver;
    naming_flags(flags, [&] {
        for (const FieldFlag& flag : field_flags())
            if (const auto value = flags.fields.find(flag.flag); value != flags.fields.end())
                for (const char* path : flag.paths) set_field(request, path, value->second);
    });
    set_fields(request, flags.settings);
    naming_flags(flags, [&] { validate(request); });
    warn_of_unused(flags, request);
    return request;
}

}  // namespace hairbake
