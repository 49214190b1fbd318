// hairbake render
#include <CLI/CLI.hpp>
#include <limits>

#include "clients/cli/commands.h"
#include "clients/cli/common_flags.h"
#include "clients/cli/exit_code.h"
#include "clients/cli/messages.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"
#include "clients/cli/progress_display.h"
#include "clients/cli/request_flags.h"
#include "clients/cli/signal_watch.h"
#include "core/base/number_text.h"
#include "core/base/short_number.h"
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
    std::array<double, 3> target{};
    const CLI::Option* target_flag = nullptr;
    bool no_transmittance = false, no_background = false;
    int threads = 0;
};

std::string text_of(const std::array<double, 3>& v) {
    return short_number(v[0]) + "," + short_number(v[1]) + "," + short_number(v[2]);
}

void parse_size(const std::string& text, FrameSettings& frame) {
    char rest = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &frame.width, &frame.height, &rest) != 2)
        throw Error(ErrorKind::usage, "size is " + text + "; allowed is WIDTHxHEIGHT", "size");
}

std::optional<double> parse_exposure(const std::string& text) {
    if (text == "auto") return {};
    const std::optional<double> stops = number_of(text);
    if (!stops || std::abs(*stops) > 64)
        throw Error(ErrorKind::usage, "exposure is " + text + "; allowed is auto or -64 to 64 stops", "exposure");
    return stops;
}

RenderRequest make_request(const RenderOptions& options) {
    RenderRequest request = options.request;
    if (options.preset) apply_preset(request.bake, *options.preset);
    set_fields(request.bake, options.settings);
    if (request.result && (options.preset || !options.settings.empty()))
        throw Error(ErrorKind::usage, "--preset and --set are not allowed with a result folder: it is baked already",
                    "set");
    parse_size(options.size, request.frame);
    if (options.target_flag->count() > 0)
        request.orbit.target = Vec3d(options.target[0], options.target[1], options.target[2]);
    request.transmittance = !options.no_transmittance;
    request.background = !options.no_background;
    return request;
}

void run_render(const RenderOptions& options) {
    const RenderRequest request = make_request(options);
    const std::optional<double> exposure = parse_exposure(options.exposure);
    warn_of_threads(options.threads);
    RenderedPicture picture;
    {
        std::vector<Phase> phases{{"read_environment", 1}};
        if (!request.result)
            phases = {{"read_hair", 1}, {"read_environment", 1}, {"transmittance", 5}, {"irradiance", 1}};
        phases.insert(phases.end(), {{"reference", 1}, {"render", 20}});
        const auto progress = make_progress_display(options.progress, phases);
        const SignalWatch watch(*progress, [] {});
        check_render(request, {options.files.begin(), options.files.end()});
        picture = render(request, options.threads, *progress);
    }
    for (const std::string& warning : picture.warnings) say_warning(warning);
    const double stops = exposure.value_or(automatic_exposure(picture));
    std::string names;
    for (const std::string& file : options.files) {
        write_picture(picture, stops, file);
        names += (names.empty() ? "" : ", ") + file;
    }
    char text[160];
    if (options.progress == "json")
        std::snprintf(text, sizeof text, "{\"event\":\"done\",\"exposure_stops\":%.17g,\"render_s\":%.3f}", stops,
                      picture.render_seconds);
    else
        std::snprintf(text, sizeof text, ": %d x %d pixels, %d samples each, in %.2f s; exposure %+.2f stops",
                      picture.width, picture.height, request.frame.samples, picture.render_seconds, stops);
    print_line((options.progress == "json" ? "" : names) + text);
}

void run(const RenderOptions& options) {
    with_json_failures(options.progress, [&] { run_render(options); });
}

void add_scene_options(CLI::App& command, RenderOptions& options) {
    RenderRequest& request = options.request;
    command.add_option("result", request.result, "result folder; without it give --hair and --env")->type_name("DIR");
    command.add_option("--out", options.files, "NAME.png or NAME.exr; may be given twice")
        ->required()
        ->type_name("FILE")
        ->allow_extra_args(false);
    command.add_option("--hair", request.bake.hair, "hair model; with a result: the path of its hair")
        ->type_name("FILE");
    command
        .add_option("--env", request.bake.environment, "HDR environment; with a result: the path of its environment")
        ->type_name("FILE");
    command
        .add_option("--occluder", request.bake.occluder,
                    "mesh that blocks light; with a result: the path of its occluder")
        ->type_name("FILE");
    command.add_option("--mesh", request.mesh, "mesh shown with the hair (a head)")->type_name("FILE");
    command.add_option("--preset", options.preset, "without a result: preset of the bake")
        ->check(offering(preset_names()))
        ->type_name("NAME")
        ->default_str(std::string(default_preset));
    command.add_option("--set", options.settings, "without a result: any field of the bake (listed below)")
        ->check(offering(field_paths()))
        ->type_name("PATH=VALUE")
        ->allow_extra_args(false);
}

void add_shading_options(CLI::App& command, RenderOptions& options) {
    RenderRequest& request = options.request;
    command
        .add_option("--mode", request.mode, "baked (the maps), brute (every light), reference (traced), directional, effective")
        ->transform(name_in_table(shading_mode_names))
        ->type_name("MODE")
        ->default_str(std::string(name_of(request.mode)));
    command.add_option("--directional", request.directional, "auto, sh or bent-cone")
        ->transform(name_in_table(directional_names))
        ->type_name("KIND")
        ->default_str("auto");
    command.add_option("--channel", request.frame.channel, "beauty, transmittance, diffuse, specular or tangent")
        ->transform(name_in_table(channel_names))
        ->type_name("CHANNEL")
        ->default_str("beauty");
    command.add_flag("--no-transmittance", options.no_transmittance, "A = 1 (modes baked and brute)");
    command.add_flag("--no-background", options.no_background, "black behind the hair");
    command
        .add_option("--light-samples", request.light_samples,
                    "shadow rays of each kernel at a hit (reference), 1 to 65536")
        ->transform(whole_number(1, 65536))
        ->type_name("N")
        ->capture_default_str();
    command.add_option("--albedo", request.look.albedo, "Kd pi^2, before it is multiplied by the colour, 0 to 1")
        ->transform(number(0, 1))
        ->type_name("X")
        ->capture_default_str();
    add_triple(command, "--color", request.look.color, 0, 1, "linear red, green, blue, 0 to 1 each")
        ->type_name("R,G,B")
        ->default_str(text_of(request.look.color));
    command.add_option("--specular", request.look.specular, "Ks, 0 to 10")
        ->transform(number(0, 10))
        ->type_name("X")
        ->capture_default_str();
    add_triple(command, "--mesh-albedo", request.look.mesh_albedo, 0, 1,
               "linear red, green, blue of the mesh, 0 to 1 each")
        ->type_name("R,G,B")
        ->default_str(text_of(request.look.mesh_albedo));
}

void add_camera_options(CLI::App& command, RenderOptions& options) {
    RenderRequest& request = options.request;
    command.add_option("--size", options.size, "pixels, each 1 to 16384")->type_name("WxH")->capture_default_str();
    command.add_option("--samples", request.frame.samples, "samples per pixel, 1 to 65536")
        ->transform(whole_number(1, 65536))
        ->type_name("N")
        ->capture_default_str();
    command.add_option("--seed", request.frame.seed, "the same seed gives the same picture")
        ->transform(whole_number(0, 0x1p53))
        ->type_name("N")
        ->capture_default_str();
    command.add_option("--azimuth", request.orbit.azimuth_deg, "degrees; 0 looks from +Z, 90 from +X")
        ->transform(any_number())
        ->type_name("DEG")
        ->capture_default_str();
    command.add_option("--elevation", request.orbit.elevation_deg, "degrees, -90 to 90")
        ->transform(number(-90, 90))
        ->type_name("DEG")
        ->capture_default_str();
    command.add_option("--fov", request.orbit.fov_deg, "vertical field of view, 1 to 150 degrees")
        ->transform(number(1, 150))
        ->type_name("DEG")
        ->capture_default_str();
    command
        .add_option("--distance", request.orbit.distance,
                    "distance of the eye from the target; default: all hair is in the picture")
        ->transform(any_number())
        ->type_name("X");
    constexpr double most = std::numeric_limits<double>::max();
    options.target_flag =
        add_triple(command, "--target", options.target, -most, most, "default: the middle of the hair")
            ->type_name("X,Y,Z");
    command.add_option("--camera", request.camera_file, "JSON: eye, target, up, fov_deg, or the orbit's fields")
        ->type_name("FILE");
    command.add_option("--exposure", options.exposure, "stops for PNG, -64 to 64, or auto")
        ->type_name("STOPS")
        ->capture_default_str();
}

}  // namespace

void add_render_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("render", "Render a picture of a result, or of hair under an environment");
    const auto options = std::make_shared<RenderOptions>();
    add_scene_options(*command, *options);
    add_shading_options(*command, *options);
    add_camera_options(*command, *options);
    add_threads_flag(*command, options->threads);
    add_progress_flag(*command, options->progress);
    command->footer(fields_help() + "\n" + command->get_footer());
    command->callback([options, &action] { action = [options] { run(*options); }; });
}

}  // namespace hairbake
