// hairbake render
#include <CLI/CLI.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/messages.h"
#include "clients/cli/progress_display.h"
#include "clients/cli/signal_watch.h"
#include "core/render.h"
#include "core/request/request_json.h"
#include "core/request/request_presets.h"

namespace hairbake {
namespace {

struct RenderOptions {
    RenderRequest request;
    std::optional<std::string> preset;
    std::vector<std::string> settings, files;
    std::string progress = "auto", size = "640x640", exposure = "auto";
    std::optional<std::array<double, 3>> target;
    bool no_transmittance = false, no_background = false;
    int threads = 0;
};

/// The names of an enum's table, for CLI11.
template <class Enum, std::size_t count>
CLI::CheckedTransformer by_name(const std::array<EnumName<Enum>, count>& table) {
    std::vector<std::pair<std::string, Enum>> names;
    for (const EnumName<Enum>& entry : table) names.emplace_back(entry.name, entry.value);
    return CLI::CheckedTransformer(names);
}

void parse_size(const std::string& text, FrameSettings& frame) {
    char rest = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &frame.width, &frame.height, &rest) != 2)
        throw Error(ErrorKind::usage, "size is " + text + "; allowed is WIDTHxHEIGHT", "size");
}

std::optional<double> parse_exposure(const std::string& text) {
    if (text == "auto") return {};
    char* end = nullptr;
    const double stops = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != 0 || !(std::abs(stops) <= 64))
        throw Error(ErrorKind::usage, "exposure is " + text + "; allowed is auto or -64 to 64 stops", "exposure");
    return stops;
}

RenderRequest make_request(const RenderOptions& options) {
    RenderRequest request = options.request;
    if (options.preset) apply_preset(request.bake, *options.preset);
    for (const std::string& setting : options.settings) {
        const std::size_t sign = setting.find('=');
        if (sign == std::string::npos)
            throw Error(ErrorKind::usage, "--set " + setting + " is not of the form path=value", "set");
        say_warnings(set_field(request.bake, setting.substr(0, sign), setting.substr(sign + 1)));
    }
    if (request.result && (options.preset || !options.settings.empty()))
        throw Error(ErrorKind::usage, "--preset and --set are not allowed with a result folder: it is baked already",
                    "set");
    parse_size(options.size, request.frame);
    if (options.target) request.orbit.target = Vec3d((*options.target)[0], (*options.target)[1], (*options.target)[2]);
    request.transmittance = !options.no_transmittance;
    request.background = !options.no_background;
    return request;
}

void run(const RenderOptions& options) {
    const RenderRequest request = make_request(options);
    const std::optional<double> exposure = parse_exposure(options.exposure);
    RenderedPicture picture;
    {
        std::vector<Phase> phases;
        if (!request.result) phases = {{"read_hair", 1}, {"transmittance", 5}, {"irradiance", 1}};
        phases.insert(phases.end(), {{"reference", 1}, {"read_environment", 1}, {"render", 20}});
        const auto progress = make_progress_display(options.progress, phases);
        const SignalWatch watch(*progress, [] {});
        picture = render(request, options.threads, *progress);
    }
    for (const std::string& warning : picture.warnings) say_warning(warning);
    const double stops = exposure.value_or(automatic_exposure(picture));
    std::string names;
    for (const std::string& file : options.files) {
        write_picture(picture, stops, file);
        names += (names.empty() ? "" : ", ") + file;
    }
    if (options.progress == "json")
        std::printf("{\"event\":\"done\",\"exposure_stops\":%.17g,\"render_s\":%.3f}\n", stops, picture.render_seconds);
    else
        std::printf("%s: %d x %d pixels, %d samples each, in %.2f s; exposure %+.2f stops\n", names.c_str(),
                    picture.width, picture.height, request.frame.samples, picture.render_seconds, stops);
}

void add_scene_options(CLI::App& command, RenderOptions& options) {
    RenderRequest& request = options.request;
    command.add_option("result", request.result, "result folder; without it give --hair and --env")->type_name("DIR");
    command.add_option("--out", options.files, "NAME.png or NAME.exr; may be given twice")
        ->required()
        ->type_name("FILE")
        ->allow_extra_args(false);
    command.add_option("--hair", request.bake.hair, "hair model; with a result: the path of its hair");
    command.add_option("--env", request.bake.environment,
                       "HDR environment; with a result: the path of its environment");
    command.add_option("--occluder", request.bake.occluder,
                       "mesh that blocks light; with a result: the path of its occluder");
    command.add_option("--mesh", request.mesh, "OBJ file shown with the hair (a head)");
    command.add_option("--preset", options.preset, "without a result: preset of the bake");
    command.add_option("--set", options.settings, "without a result: any field of the bake")
        ->type_name("PATH=VALUE")
        ->allow_extra_args(false);
}

void add_shading_options(CLI::App& command, RenderOptions& options) {
    RenderRequest& request = options.request;
    command
        .add_option("--mode", request.mode, "baked (the maps), brute (every light), reference (traced), directional")
        ->transform(by_name(shading_mode_names))
        ->type_name("MODE");
    command.add_option("--directional", request.directional, "auto, sh or bent-cone")
        ->transform(by_name(directional_names))
        ->type_name("KIND");
    command.add_option("--channel", request.frame.channel, "beauty, transmittance, diffuse, specular or tangent")
        ->transform(by_name(channel_names))
        ->type_name("CHANNEL");
    command.add_flag("--no-transmittance", options.no_transmittance, "A = 1 (modes baked and brute)");
    command.add_flag("--no-background", options.no_background, "black behind the hair");
    command.add_option("--light-samples", request.light_samples, "shadow rays of each kernel at a hit (reference)")
        ->capture_default_str();
    command.add_option("--albedo", request.look.albedo, "Kd pi^2, before it is multiplied by the colour")
        ->capture_default_str();
    command.add_option("--color", request.look.color, "linear red, green, blue, 0 to 1")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--specular", request.look.specular, "Ks")->capture_default_str();
    command.add_option("--mesh-albedo", request.look.mesh_albedo, "linear red, green, blue")
        ->delimiter(',')
        ->capture_default_str();
}

void add_camera_options(CLI::App& command, RenderOptions& options) {
    RenderRequest& request = options.request;
    command.add_option("--size", options.size, "pixels")->type_name("WxH")->capture_default_str();
    command.add_option("--samples", request.frame.samples, "samples per pixel")->capture_default_str();
    command.add_option("--seed", request.frame.seed, "the same seed gives the same picture")->capture_default_str();
    command.add_option("--azimuth", request.orbit.azimuth_deg, "degrees; 0 looks from +Z, 90 from +X")
        ->capture_default_str();
    command.add_option("--elevation", request.orbit.elevation_deg, "degrees, -90 to 90")->capture_default_str();
    command.add_option("--fov", request.orbit.fov_deg, "vertical field of view, degrees")->capture_default_str();
    command.add_option("--distance", request.orbit.distance,
                       "distance of the eye from the target; default: all hair is in the picture");
    command.add_option("--target", options.target, "x,y,z; default: the middle of the hair")->delimiter(',');
    command.add_option("--camera", request.camera_file, "JSON: eye, target, up, fov_deg, or the orbit's fields")
        ->type_name("FILE");
    command.add_option("--exposure", options.exposure, "stops for PNG, or auto")->capture_default_str();
}

}  // namespace

void add_render_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("render", "Render a picture of a result, or of hair under an environment");
    const auto options = std::make_shared<RenderOptions>();
    add_scene_options(*command, *options);
    add_shading_options(*command, *options);
    add_camera_options(*command, *options);
    command->add_option("--threads", options->threads, "threads; 0: one per core")->check(CLI::Range(0, 1024));
    command->add_option("--progress", options->progress, "auto (a bar on a terminal), json or none")
        ->check(CLI::IsMember({"auto", "json", "none"}));
    command->callback([options, &action] { action = [options] { run(*options); }; });
}

}  // namespace hairbake
