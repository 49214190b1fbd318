// hairbake upload
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"
#include "clients/cli/remote/outcome.h"
#include "clients/cli/remote/upload.h"

namespace hairbake {
namespace {

using Json = Server::Json;

struct UploadOptions {
    ConnectionFlags connection;
    std::vector<std::string> files;
    std::string kind, name, note;
};

/// "stage1/sunset" is one path of several words.
bool is_name(const std::string& name) {
    const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '.' || c == '_' || c == '-' || c == '/'; };
    return !name.empty() && name.size() <= 200 && std::all_of(name.begin(), name.end(), fits);
}

void check(const UploadOptions& options) {
    if (options.name.empty()) return;
    if (options.files.size() != 1 || options.kind.empty())
        throw Error(ErrorKind::usage, "--name needs exactly one file and --as", "name");
    if (!is_name(options.name))
        throw Error(ErrorKind::usage, "name is " + options.name + "; allowed are up to 200 letters, digits and . _ - /",
                    "name");
}

void run(const UploadOptions& options) {
    check(options);
    InputFiles inputs;
    for (const std::string& file : options.files) inputs.add(file, "file");
    run_phase(options.connection, server_options(options.connection), {{"digest", 1}, {"upload", 4}},
              [&](Server& server) {
                  inputs.send(server);
                  for (const std::string& file : options.files) {
                      const Json digest{{"sha256", inputs.reference(file).substr(7)}};
                      if (options.kind == "model" || options.kind == "environment")
                          server.json("POST", "/v1/" + options.kind + "s", digest.dump());
                      Json named = digest;
                      if (!options.note.empty()) named["note"] = options.note;
                      if (!options.name.empty())
                          server.json("PUT", "/v1/names/" + options.kind + "/" + options.name, named.dump());
                  }
              });
    for (const std::string& file : options.files)
        print_line(options.connection.json() ? R"({"event":"stored","file":)" + json_string(file) + R"(,"reference":)" +
                                                   json_string(inputs.reference(file)) + "}"
                                             : inputs.reference(file) + " " + file);
}

}  // namespace

void add_upload_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("upload", "Send files to a service that lacks them");
    const auto options = std::make_shared<UploadOptions>();
    command->add_option("file", options->files, "hair models, environments, meshes")->required()->type_name("FILE");
    command
        ->add_option("--as", options->kind,
                     "model or environment: the service reads and lists it; mesh: for --name only")
        ->check(one_of({"model", "environment", "mesh"}));
    command->add_option("--name", options->name, "makes name:NAME refer to this file; earlier versions stay")
        ->type_name("NAME");
    command->add_option("--note", options->note, "kept with the name's new version")->type_name("TEXT");
    command->footer("Prints sha256:DIGEST and the file, one line each. An interrupted upload is resumed.\n\n");
    add_connection_flags(*command, options->connection);
    command->callback([options, &action] {
        action = [options] { with_json_failures(options->connection.progress, [&] { run(*options); }); };
    });
}

}  // namespace hairbake
