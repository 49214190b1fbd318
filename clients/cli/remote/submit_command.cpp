// hairbake submit
#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/messages.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"
#include "clients/cli/remote/outcome.h"
#include "clients/cli/remote/result_warnings.h"
#include "clients/cli/remote/upload.h"
#include "clients/cli/request_flags.h"
#include "core/bake.h"
#include "core/request/request_json.h"

namespace hairbake {
namespace {

using Json = Server::Json;

struct SubmitOptions {
    RequestFlags request;
    ConnectionFlags connection;
    std::vector<std::string> hairs;
    int priority = 0;
    bool wait = false;
    std::string folder;
};

/// A request, its label, the folder of its result, and its bake.
struct Job {
    BakeRequest request;
    std::string label, folder, id, state;
    std::vector<std::string> warnings;  ///< of a bake that was done already
};

/// "groom" of a path or a name, the first digits of a digest.
std::string short_name(const std::string& hair) {
    if (hair.starts_with("sha256:")) return hair.substr(7, 12);
    return std::filesystem::path(hair.starts_with("name:") ? hair.substr(5) : hair).stem();
}

std::vector<Job> make_jobs(const SubmitOptions& options) {
    std::vector<Job> jobs;
    std::map<std::string, std::string> folders;
    for (std::size_t i = 0; i == 0 || i < options.hairs.size(); ++i) {
        RequestFlags flags = options.request;
        if (!options.hairs.empty()) flags.hair = options.hairs[i];
        Job job{make_request(flags), "", options.folder, "", "", {}};
        job.label = job.request.hair.value_or(job.request.environment.value_or(""));
        if (!job.folder.empty() && options.hairs.size() > 1) {
            job.folder = std::filesystem::path(options.folder) / short_name(job.label);
            const auto [other, fresh] = folders.emplace(job.folder, job.label);
            if (!fresh)
                throw Error(ErrorKind::usage,
                            other->second + " and " + job.label + " would both be fetched into " + job.folder, "fetch");
        }
        if (!job.folder.empty()) {
            check_outside(job.folder, inputs_of(job.request));
            check_request_file(flags, job.folder);
            prove_writable(job.folder);
        }
        jobs.push_back(std::move(job));
    }
    return jobs;
}

void submit(Server& server, const InputFiles& inputs, Job& job, int priority) {
    Json body = Json::parse(to_json(inputs.referenced(job.request)));
    body["priority"] = priority;
    const Json answer = server.json("POST", "/v1/bakes", body.dump());
    job.id = id_in(answer, "id");
    job.state = plain(answer.at("state").get<std::string>());
}

void tell_submitted(const SubmitOptions& options, const Job& job) {
    if (options.connection.json())
        print_line(Json{{"event", "submitted"}, {"id", job.id}, {"state", job.state}, {"input", job.label}}.dump(
            -1, ' ', false, Json::error_handler_t::replace));
    else if (options.wait)
        say_note("bake " + job.id + " of " + job.label + " is " + job.state);
    else
        print_line(job.id + " " + job.state + " " + job.label);
}

void run(SubmitOptions options) {
    options.wait = options.wait || !options.folder.empty();
    std::vector<Job> jobs = make_jobs(options);
    InputFiles inputs;
    for (const Job& job : jobs) inputs.add(job.request);
    const ServerOptions server_settings = server_options(options.connection);
    run_phase(options.connection, server_settings, {{"digest", 1}, {"upload", 4}}, [&](Server& server) {
        inputs.send(server);
        for (Job& job : jobs) {
            submit(server, inputs, job, options.priority);
            if (job.state == "done" && !options.wait) job.warnings = warnings_of_bake(server, job.id);
        }
    });
    for (const Job& job : jobs) {
        for (const std::string& warning : job.warnings)
            say_bake_warnings(jobs.size() > 1 ? job.id : "", {inputs.with_paths(warning)});
        tell_submitted(options, job);
    }
    if (!options.wait) return;

    std::vector<std::string> ids;
    std::map<std::string, std::string> folders;
    Awaited awaited;
    for (const Job& job : jobs) {
        if (folders.emplace(job.id, job.folder).second) ids.push_back(job.id);
        awaited.which += (awaited.which.empty() ? "" : " ") + job.id;
    }
    awaited.wait = [&](Server& server) { return wait_for_bakes(server, ids); };
    awaited.folder = [&](const std::string& id) {
        const auto found = folders.find(id);
        return found == folders.end() ? "" : found->second;
    };
    awaited.words = [&](std::string text) { return inputs.with_paths(std::move(text)); };
    awaited.remark = "; " + std::to_string(inputs.sent_files()) + " files sent, " + in_megabytes(inputs.sent_bytes());
    await_bakes(options.connection, server_settings, awaited);
}

}  // namespace

void add_submit_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("submit", "Bake on a service; takes the flags of `bake`");
    const auto options = std::make_shared<SubmitOptions>();
    command
        ->add_option("--hair", options->hairs,
                     "hair model; may be given more than once: one bake for each. Every input is a file, sha256:DIGEST "
                     "or name:NAME")
        ->allow_extra_args(false);
    add_request_flags(*command, options->request,
                      "HDR environment, one picture (lat-long, cross or strip); alone: irradiance maps only");
    command->add_option("--priority", options->priority, "-10 to 10: higher ones are baked first")
        ->transform(whole_number(-10, 10))
        ->type_name("N")
        ->capture_default_str();
    command->add_flag("--wait", options->wait, "wait until the bakes have ended");
    command
        ->add_option("--fetch", options->folder,
                     "wait, then fetch the result into this folder; several bakes: into DIR/NAME OF THE HAIR")
        ->type_name("DIR");
    add_connection_flags(*command, options->connection);
    command->footer(request_flags_help() +
                    "Without --wait it prints one line for each bake: its id, its state, its hair.\n\n" +
                    command->get_footer());
    command->callback([options, &action] {
        action = [options] { with_json_failures(options->connection.progress, [&] { run(*options); }); };
    });
}

}  // namespace hairbake
