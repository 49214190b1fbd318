#include "clients/cli/request_flags.h"

#include <CLI/CLI.hpp>
#include <fstream>

#include "clients/cli/messages.h"
#include "core/request/request_json.h"
#include "core/request/request_presets.h"

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
        {"--directions", {"transmittance.directions"}, "directions of the transmittance, 1 to 4096"},
        {"--voxels", {"transmittance.voxels"}, "voxels on the longest axis, 32 to 1024, or auto"},
        {"--width", {"strand.width"}, "strand diameter in the model's unit, instead of the file's"},
        {"--opacity", {"strand.opacity"}, "share of light that one crossing stops, 0 to 1, or from_file"},
        {"--specular-maps", {"irradiance.specular_maps"}, "number of specular maps, 2 to 257"},
        {"--exponent", {"fiber.kajiya_kay.exponent"}, "Kajiya-Kay exponent, 0 to 4096"},
        {"--face-size", {"irradiance.face_size"}, "texels per edge of a cube face, 4 to 256"},
        {"--method", {"irradiance.method"}, "irradiance by exact or sh"},
        {"--sh-bands",
         {"irradiance.sh_bands.diffuse", "irradiance.sh_bands.specular"},
         "bands of sh: a number or auto"},
        {"--layout", {"environment_settings.layout"}, "of the environment: auto, latlong, faces, horizontal_cross ..."},
        {"--outputs", {"outputs"}, "formats of the result, with commas (listed below)"},
    };
    return flags;
}

std::string text_of(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(ErrorKind::bad_input, file + ": " + std::generic_category().message(errno), "request");
    constexpr std::size_t most = 1 << 20;
    std::string text(most + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > most) throw Error(ErrorKind::usage, file + " is too long; allowed are 1 MiB", "request");
    return text;
}

/// Warns of a flag that the method does not read; a later setting may have chosen that method.
void warn_of_unused(const RequestFlags& flags, const BakeRequest& request) {
    if (flags.fields.contains("--sh-bands") && request.irradiance.method == IrradianceMethod::exact)
        say_warning("--sh-bands is not used: irradiance.method is exact; the bands are those of --method sh");
}

}  // namespace

void add_request_flags(CLI::App& command, RequestFlags& flags, const std::string& environment_help) {
    command.add_option("--env", flags.environment, environment_help);
    command.add_option("--occluder", flags.occluder, "mesh (OBJ) that stops light completely: the head");
    command.add_option("--receiver", flags.receiver, "mesh (OBJ) on which the hair's shadow is baked too");
    command.add_option("--preset", flags.preset, "draft, final, paper or v1 (see hairbake presets)");
    command.add_option("--request", flags.request_file, "JSON file with fields of the request");
    for (const FieldFlag& flag : field_flags())
        command
            .add_option_function<std::string>(
                flag.flag, [&flags, name = flag.flag](const std::string& value) { flags.fields[name] = value; },
                flag.help)
            ->type_name("VALUE");
    command.add_option("--set", flags.settings, "any field by its path, e.g. transmittance.method=trace")
        ->type_name("PATH=VALUE")
        ->allow_extra_args(false);
}

std::string request_flags_help() {
    std::string outputs;
    for (const std::string& format : output_formats()) outputs += (outputs.empty() ? "" : ", ") + format;
    return "Outputs: " + outputs + ".\nLater wins: defaults, --preset, --request, flags, --set.\n";
}

BakeRequest make_request(const RequestFlags& flags) {
    BakeRequest request;
    if (flags.preset) apply_preset(request, *flags.preset);
    if (flags.request_file) say_warnings(merge_json(request, text_of(*flags.request_file), *flags.request_file));
    if (flags.hair) request.hair = flags.hair;
    if (flags.environment) request.environment = flags.environment;
    if (flags.occluder) request.occluder = flags.occluder;
    if (flags.receiver) request.receiver = flags.receiver;
    for (const FieldFlag& flag : field_flags())
        if (const auto value = flags.fields.find(flag.flag); value != flags.fields.end())
            for (const char* path : flag.paths) set_field(request, path, value->second);
    for (const std::string& setting : flags.settings) {
        const std::size_t sign = setting.find('=');
        if (sign == std::string::npos)
            throw Error(ErrorKind::usage, "--set " + setting + " is not of the form path=value", "set");
        say_warnings(set_field(request, setting.substr(0, sign), setting.substr(sign + 1)));
    }
    validate(request);
    warn_of_unused(flags, request);
    return request;
}

}  // namespace hairbake
