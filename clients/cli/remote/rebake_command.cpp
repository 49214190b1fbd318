// hairbake rebake
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/messages.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"
#include "clients/cli/remote/outcome.h"
#include "clients/cli/remote/upload.h"
#include "core/base/json_nesting.h"

namespace hairbake {
namespace {

using Json = Server::Json;

struct RebakeOptions {
    ConnectionFlags connection;
    std::string environment, replaces, name, folder;
    std::map<std::string, std::string> blocks;  ///< JSON objects of the request's blocks that change, by name
    std::vector<std::string> bakes, models;
    int priority = 0;
    bool dry_run = false, wait = false;
};

/// The request; files among its values must have been sent.
Json body_of(const RebakeOptions& options, const InputFiles& inputs) {
    Json body{{"environment", inputs.reference(options.environment)}, {"priority", options.priority}};
    if (!options.bakes.empty()) body["bakes"] = options.bakes;
    if (!options.replaces.empty()) body["replaces"] = inputs.reference(options.replaces);
    if (!options.name.empty()) body["name"] = options.name;
    for (const std::string& model : options.models) body["models"].push_back(inputs.reference(model));
    for (const auto& [block, json] : options.blocks) body[block] = Json::parse(json);
    return body;
}

void check(const RebakeOptions& options) {
    const int sources =
        !options.bakes.empty() + !options.replaces.empty() + !options.name.empty() + !options.models.empty();
    if (sources != 1)
        throw Error(ErrorKind::usage, "exactly one of --bake, --replaces, --name and --model is needed", "bakes");
    for (const auto& [block, json] : options.blocks) {
        check_nesting(json, block, ErrorKind::usage, block);
        if (!Json::parse(json, nullptr, false).is_object())
            throw Error(ErrorKind::usage, block + " is " + json + "; allowed is a JSON object", block);
    }
    check_ids(options.bakes, "bake");
}

/// "3 transmittance and 1 irradiance stages": of whatever stages the server counts, without those of which there is none.
std::string counts_text(const Json& counts) {
    std::vector<std::string> parts;
    for (const auto& [stage, count] : counts.items())
        if (count.get<std::int64_t>() > 0)
            parts.push_back(std::to_string(count.get<std::int64_t>()) + " " + plain(stage));
    std::string text = parts.empty() ? "no" : "";
    for (std::size_t i = 0; i < parts.size(); ++i)
        text += (i == 0 ? "" : i + 1 < parts.size() ? ", " : " and ") + parts[i];
    return text + " stages";
}

void tell(const RebakeOptions& options, const Json& answer) {
    if (options.connection.json()) {
        Json line{{"event", options.dry_run ? "forecast" : "submitted"}};
        line.update(answer);
        return print_line(line.dump(-1, ' ', false, Json::error_handler_t::replace));
    }
    const std::string bakes = std::to_string(answer.at("bakes").get<std::int64_t>()) + " bakes";
    if (options.dry_run)
        print_line(bakes + ", " + std::to_string(answer.at("done_bakes").get<std::int64_t>()) +
                   " of them done: " + counts_text(answer.at("reused_stages")) + " are stored, " +
                   counts_text(answer.at("computed_stages")) + " would be computed");
    else if (options.wait)
        say_note("batch " + id_in(answer, "id") + " of " + bakes);
    else
        print_line(id_in(answer, "id") + " " + bakes);
}

void run(RebakeOptions options) {
    options.wait = options.wait || !options.folder.empty();
    check(options);
    if (!options.folder.empty()) prove_writable(std::filesystem::path(options.folder) / "any-bake");
    InputFiles inputs;
    inputs.add(options.environment, "environment");
    if (!options.replaces.empty()) inputs.add(options.replaces, "replaces");
    for (const std::string& model : options.models) inputs.add(model, "models");
    const ServerOptions server_settings = server_options(options.connection);
    Json answer;
    run_phase(options.connection, server_settings, {{"digest", 1}, {"upload", 4}}, [&](Server& server) {
        inputs.send(server);
        answer = server.json("POST", options.dry_run ? "/v1/rebakes?dry_run=1" : "/v1/rebakes",
                             body_of(options, inputs).dump());
        if (!options.dry_run) id_in(answer, "id");
    });
    tell(options, answer);
    if (options.dry_run || !options.wait) return;

    const std::string batch = id_in(answer, "id");
    Awaited awaited;
    awaited.which = "--batch " + batch;
    awaited.wait = [&](Server& server) { return wait_for_batch(server, batch); };
    awaited.words = [&](std::string text) { return inputs.with_paths(std::move(text)); };
    awaited.inputs = {{"environment", options.environment}};
    for (const std::string& model : options.models) awaited.inputs.push_back({"model", model});
    if (!options.folder.empty())
        awaited.folder = [&](const std::string& id) { return (std::filesystem::path(options.folder) / id).string(); };
    await_bakes(options.connection, server_settings, awaited);
}

}  // namespace

void add_rebake_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("rebake", "Bake grooms again on a service under a new environment");
    const auto options = std::make_shared<RebakeOptions>();
    command->add_option("--env", options->environment, "the new environment: a file, sha256:DIGEST or name:NAME")
        ->required();
    command->add_option("--bake", options->bakes, "id of a bake to repeat; may be given more than once")
        ->type_name("ID");
    command->add_option("--replaces", options->replaces, "every groom that was baked under this environment");
    command->add_option("--name", options->name, "every groom that was baked under the environment of this name");
    command->add_option("--model", options->models, "these hair models, each as in its latest bake");
    for (const char* block : {"irradiance", "environment_settings", "fiber"}) {
        std::string flag = std::string("--") + block;
        std::replace(flag.begin(), flag.end(), '_', '-');
        command
            ->add_option_function<std::string>(
                flag, [options, block](const std::string& json) { options->blocks[block] = json; },
                std::string("fields of the block ") + block + " that change")
            ->type_name("JSON");
    }
    command->add_option("--priority", options->priority, "-10 to 10: higher ones are baked first")
        ->transform(whole_number(-10, 10))
        ->type_name("N")
        ->capture_default_str();
    command->add_flag("--dry-run", options->dry_run, "only print what is stored and what would be computed");
    command->add_flag("--wait", options->wait, "wait until all bakes have ended");
    command->add_option("--fetch", options->folder, "wait, then fetch each result into DIR/ID")->type_name("DIR");
    command->footer("Transmittance is not computed again. Prints the batch's id and how many bakes it has.\n\n");
    add_connection_flags(*command, options->connection);
    command->callback([options, &action] {
        action = [options] { with_json_failures(options->connection.progress, [&] { run(*options); }); };
    });
}

}  // namespace hairbake
