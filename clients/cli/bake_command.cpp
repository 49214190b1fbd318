// hairbake bake
#include <CLI/CLI.hpp>
#include <fstream>
#include <iterator>

#include "clients/cli/commands.h"
#include "clients/cli/exit_code.h"
#include "clients/cli/messages.h"
#include "clients/cli/progress_display.h"
#include "clients/cli/signal_watch.h"
#include "core/bake.h"
#include "core/request_json.h"
#include "core/request_presets.h"

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
        {"--voxels", {"transmittance.voxels"}, "voxels on the longest axis, 32 to 1024"},
        {"--width", {"strand.width"}, "strand diameter in the model's unit, instead of the file's"},
        {"--opacity", {"strand.opacity"}, "share of light that one crossing stops, 0 to 1, or from_file"},
        {"--specular-maps", {"irradiance.specular_maps"}, "number of specular maps, 2 to 257"},
        {"--exponent", {"irradiance.exponent"}, "Kajiya-Kay exponent, 0 to 4096"},
        {"--face-size", {"irradiance.face_size"}, "texels per edge of a cube face, 4 to 256"},
        {"--method", {"irradiance.method"}, "irradiance by exact or sh"},
        {"--sh-bands",
         {"irradiance.sh_bands.diffuse", "irradiance.sh_bands.specular"},
         "bands of sh: a number or auto"},
        {"--layout", {"irradiance.layout"}, "of the environment: auto, latlong, faces, horizontal_cross ..."},
        {"--outputs", {"outputs"}, "files beside the manifest, of npy,exr,hair,ktx2,dds,raw,glb,vdb"},
    };
    return flags;
}

struct Options {
    std::optional<std::string> hair, environment, occluder, request_file, preset;
    std::string folder, progress = "auto";
    std::map<std::string, std::string> fields;  ///< flag to value
    std::vector<std::string> settings;          ///< path=value
    int threads = 0;
};

std::string text_of(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(ErrorKind::bad_input, file + ": " + std::generic_category().message(errno), "request");
    constexpr std::size_t most = 1 << 20;
    std::string text(most + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > most) throw Error(ErrorKind::usage, file + " is longer than a request may be (1 MiB)", "request");
    return text;
}

/// Defaults, then the preset, the request file, the flags and --set: what comes later wins.
BakeRequest make_request(const Options& options) {
    BakeRequest request;
    if (options.preset) apply_preset(request, *options.preset);
    if (options.request_file) merge_json(request, text_of(*options.request_file), *options.request_file);
    if (options.hair) request.hair = options.hair;
    if (options.environment) request.environment = options.environment;
    if (options.occluder) request.occluder = options.occluder;
    for (const FieldFlag& flag : field_flags())
        if (const auto value = options.fields.find(flag.flag); value != options.fields.end())
            for (const char* path : flag.paths) set_field(request, path, value->second);
    for (const std::string& setting : options.settings) {
        const std::size_t sign = setting.find('=');
        if (sign == std::string::npos)
            throw Error(ErrorKind::usage, "--set " + setting + " is not of the form path=value", "set");
        set_field(request, setting.substr(0, sign), setting.substr(sign + 1));
    }
    validate(request);
    return request;
}

/// Rough shares of time; the estimate of the time left corrects itself as the bake goes on.
std::vector<PlannedStage> plan(const BakeRequest& request) {
    std::vector<PlannedStage> stages;
    if (request.hair) {
        const bool trace = request.transmittance.method == TransmittanceMethod::trace;
        stages.push_back({"read_hair", 1});
        stages.push_back({"transmittance", trace ? 100.0 : 10.0});
        if (request.transmittance.reference_vertices > 0) stages.push_back({"reference", 10});
    }
    if (request.environment) {
        stages.push_back({"read_environment", 2});
        stages.push_back({"irradiance", 3});
    }
    stages.push_back({"write", 4});
    return stages;
}

std::string summary(const BakeResult& result, const std::string& folder) {
    char text[256];
    std::string line = folder + ":";
    if (result.transmittance) {
        std::snprintf(text, sizeof text, " transmittance of %zu vertices in %.2f s",
                      result.transmittance->average.size(), result.measured.timings_s.at("transmittance"));
        line += text;
        if (result.error_bar && result.error_bar->vertices > 0) {
            std::snprintf(text, sizeof text, " (RMSE %.4f, bias %+.4f)", result.error_bar->rmse,
                          result.error_bar->bias);
            line += text;
        }
    }
    if (result.irradiance) {
        std::snprintf(text, sizeof text, "%s %zu maps of %dx%dx6 in %.2f s", result.transmittance ? "," : "",
                      1 + result.irradiance->specular.size(), result.irradiance->face_size,
                      result.irradiance->face_size, result.measured.timings_s.at("irradiance"));
        line += text;
    }
    std::snprintf(text, sizeof text, "; peak memory %.0f MB", double(result.measured.peak_memory_bytes) / 1e6);
    return line + text;
}

void tell_done(const BakeResult& result, const Options& options) {
    for (const std::string& warning : result.warnings) say_warning(warning);
    if (options.progress == "json")
        std::printf("{\"event\":\"done\",\"folder\":%s,\"id\":%s}\n", json_string(options.folder).c_str(),
                    json_string(result.id).c_str());
    else
        std::printf("%s\n", summary(result, options.folder).c_str());
}

void run_bake(const Options& options) {
    const BakeRequest request = make_request(options);
    check_result_folder(options.folder);
    BakeResult result;
    {
        const auto progress = make_progress_display(options.progress, plan(request));
        const SignalWatch watch(*progress, [&] { discard_staging(options.folder); });
        result = bake(request, options.threads, *progress);
        write_result(result, options.folder, *progress);
    }
    tell_done(result, options);
}

/// The failure as a JSON line too, for programs that read them.
void run(const Options& options) {
    try {
        run_bake(options);
    } catch (...) {
        const Error error = current_error();
        if (options.progress == "json")
            std::printf("{\"event\":\"error\",\"kind\":%s,\"field\":%s,\"message\":%s}\n",
                        json_string(name_of(error.kind())).c_str(), json_string(error.field()).c_str(),
                        json_string(error.what()).c_str());
        throw;
    }
}

}  // namespace

void add_bake_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("bake", "Bake transmittance and irradiance maps into a result folder");
    const auto options = std::make_shared<Options>();
    command->add_option("--hair", options->hair, "hair model; alone: transmittance only");
    command->add_option(
        "--env", options->environment,
        "HDR environment: a picture, or a cube's six as a folder or sky_{face}.hdr; alone: irradiance maps only");
    command->add_option("--occluder", options->occluder, "mesh (OBJ) that stops light completely: the head");
    command->add_option("--out", options->folder, "result folder: new, empty or an earlier result")->required();
    command->add_option("--preset", options->preset, "draft, final or paper (see hairbake presets)");
    command->add_option("--request", options->request_file, "JSON file with fields of the request");
    for (const FieldFlag& flag : field_flags())
        command
            ->add_option_function<std::string>(
                flag.flag, [options, name = flag.flag](const std::string& value) { options->fields[name] = value; },
                flag.help)
            ->type_name("VALUE");
    command->add_option("--set", options->settings, "any field by its path, e.g. transmittance.method=trace")
        ->type_name("PATH=VALUE")
        ->allow_extra_args(false);
    command->add_option("--threads", options->threads, "threads; 0: one per core")->check(CLI::Range(0, 1024));
    command
        ->add_option("--progress", options->progress,
                     "auto (a bar on a terminal), json (lines on standard output) or none")
        ->check(CLI::IsMember({"auto", "json", "none"}));
    command->footer("Later wins: defaults, --preset, --request, flags, --set.\n\n" + exit_code_help());
    command->callback([options, &action] { action = [options] { run(*options); }; });
}

}  // namespace hairbake
