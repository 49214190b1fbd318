// hairbake presets
#include <CLI/CLI.hpp>

#include "clients/cli/commands.h"
#include "core/request/request_json.h"
#include "core/request/request_presets.h"

namespace hairbake {
namespace {

void list_presets() {
    for (const Preset& preset : presets())
        std::printf("%-8.*s%s\n", static_cast<int>(preset.name.size()), preset.name.data(),
                    preset_description(preset).c_str());
}

void show_preset(const std::string& name) {
    BakeRequest request;
    apply_preset(request, name);
    std::printf("%s\n", to_json(request).c_str());
}

}  // namespace

void add_presets_command(CLI::App& app, Action& action) {
    struct Options {
        std::optional<std::string> name;
        bool schema = false;
    };
    CLI::App* command = app.add_subcommand("presets", "List the presets, or show the request that one makes");
    const auto options = std::make_shared<Options>();
    command->add_option("name", options->name, "show this preset's request in full")->type_name("NAME");
    command->add_flag("--schema", options->schema, "print the request's JSON schema");
    command->callback([options, &action] {
        action = [options] {
            if (options->schema)
                std::fwrite(request_schema().data(), 1, request_schema().size(), stdout);
            else if (options->name)
                show_preset(*options->name);
            else
                list_presets();
        };
    });
}

}  // namespace hairbake
