// hairbake sample
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "clients/cli/commands.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"
#include "clients/cli/progress_display.h"
#include "clients/cli/signal_watch.h"
#include "core/sample/sample.h"

namespace hairbake {

void add_sample_command(CLI::App& app, Action& action) {
    struct Options {
        std::string folder, style = std::string(name_of(GroomStyle::straight));
        SampleSettings settings;
    };
    CLI::App* command = app.add_subcommand("sample", "Write a sample groom, a head and three HDR skies");
    const auto options = std::make_shared<Options>();
    SampleSettings& settings = options->settings;
    command->add_option("folder", options->folder, "folder of the files; replaces files of the same names")
        ->required()
        ->type_name("DIR");
    CLI::Option* style = command->add_option("--style", options->style, "straight, wavy or curly");
    CLI::Option* vertices = command->add_option("--vertices", settings.vertices, "vertices of the groom")
                                ->transform(whole_number(0, 0x1p53))
                                ->type_name("N")
                                ->capture_default_str();
    std::vector<std::string> styles;
    for (const NamedGroomStyle& named : groom_styles) styles.emplace_back(named.name);
    style->check(one_of(styles))->type_name("STYLE")->capture_default_str();
    command->add_option("--paper-model", settings.paper_model, "1 to 4: a groom of a published model's size")
        ->transform(whole_number(1, 4))
        ->type_name("N")
        ->excludes(style)
        ->excludes(vertices);
    command->add_option("--map-width", settings.map_width, "width of the maps, even, 16 to 4096")
        ->transform(whole_number(0, 1e9))
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--seed", settings.seed, "the same seed gives the same files")
        ->transform(whole_number(0, 0x1p53))
        ->type_name("N")
        ->capture_default_str();
    command->callback([options, &action] {
        options->settings.style = groom_style_named(options->style);
        action = [options] {
            const auto progress = make_progress_display("auto", {{"write", 1}});
            const SignalWatch watch(*progress, [&] { discard_sample_parts(options->folder); });
            for (const auto& file : write_samples(options->folder, options->settings, *progress))
                print_line(file.string());
        };
    });
}

}  // namespace hairbake
