// hairbake presets
#include <CLI/CLI.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"
#include "clients/cli/request_flags.h"
#include "core/request/request_json.h"
#include "core/request/request_presets.h"

namespace hairbake {
namespace {

void list_presets() {
    const auto row = [](std::string name, const std::string& description) {
        name.resize(9, ' ');
        return name + description + "\n";
    };
    const BakeRequest standard;
    const std::string size = std::to_string(standard.irradiance.face_size);
    std::string list =
        row(std::string(default_preset), "Without --preset: " + std::to_string(standard.transmittance.directions) +
                                             " directions, " + std::to_string(standard.irradiance.specular_maps) +
                                             " specular maps of " + size + "x" + size + "x6.");
    for (const Preset& preset : presets()) list += row(std::string(preset.name), preset_description(preset));
    print_text(list);
}

void show_preset(const std::string& name) {
    BakeRequest request;
    apply_preset(request, name);
    print_line(to_json(request));
}

}  // namespace

void add_presets_command(CLI::App& app, Action& action) {
    struct Options {
        std::optional<std::string> name;
        bool schema = false;
    };
    CLI::App* command = app.add_subcommand("presets", "List the presets, or show the request that one makes");
    const auto options = std::make_shared<Options>();
    command
        ->add_option("name", options->name, "show this preset's request in full; default: all fields at their defaults")
        ->check(offering(preset_names()))
        ->type_name("NAME");
    command->add_flag("--schema", options->schema, "print the request's JSON schema");
    command->callback([options, &action] {
        action = [options] {
            if (options->schema)
                print_text(request_schema());
            else if (options->name)
                show_preset(*options->name);
            else
                list_presets();
        };
    });
}

}  // namespace hairbake
