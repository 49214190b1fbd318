// hairbake status, hairbake cancel
#include <CLI/CLI.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"
#include "clients/cli/remote/outcome.h"

namespace hairbake {
namespace {

using Json = Server::Json;

struct StatusOptions {
    ConnectionFlags connection;
    std::vector<std::string> ids;
    std::string batch, state;
    bool json = false;
};

/// The name that a request used for an input, with its version; else the beginning of its digest; else nothing.
std::string input_text(const Json& view, const std::string& field) {
    const Json names = view.value("names", Json::object());
    if (names.contains(field)) {
        const Json& name = names[field];
        const std::string version = name.contains("version") ? "@" + name["version"].dump() : "";
        return plain(text_in(name, "path") + version);
    }
    const std::string digest = plain(text_in(view, field == "hair" ? "model" : field.c_str()));
    return digest.substr(0, 12);
}

/// "ID running 43 %, 12 s left; "title"; hair 0123456789ab, environment stage1/sunset@2; created 2026-11-28T10:00:00Z"
std::string line_of(const Json& view) {
    const std::string state = plain(text_in(view, "state"));
    std::string line = id_in(view, "id") + " " + state;
    if (state == "running" && view.contains("fraction"))
        line += " " + std::to_string(std::lround(100 * view["fraction"].get<double>())) + " %";
    if (view.contains("seconds_left") && view["seconds_left"].is_number())
        line += ", " + std::to_string(std::lround(view["seconds_left"].get<double>())) + " s left";
    if (const std::string title = plain(text_in(view, "title")); !title.empty()) line += "; \"" + title + "\"";
    for (const char* field : {"hair", "environment", "occluder", "receiver"})
        if (const std::string input = input_text(view, field); !input.empty())
            line += std::string("; ") + field + " " + input;
    for (const char* time : {"created", "finished"})
        if (const std::string text = plain(text_in(view, time)); !text.empty())
            line += std::string("; ") + time + " " + text;
    if (view.contains("error") && view["error"].is_object()) line += ": " + plain(text_in(view["error"], "message"));
    return line;
}

/// "ID: 12 done, 26 queued, 2 running; created 2026-11-28T10:00:00Z"
std::string batch_line(const Json& view) {
    std::string line = id_in(view, "id") + ":";
    for (const auto& [state, count] : view.at("states").items())
        if (count.get<std::int64_t>() > 0)
            line += (line.ends_with(":") ? " " : ", ") + std::to_string(count.get<std::int64_t>()) + " " + plain(state);
    if (const std::string created = plain(text_in(view, "created")); !created.empty()) line += "; created " + created;
    return line;
}

std::vector<Json> views(Server& server, const StatusOptions& options) {
    std::vector<Json> found;
    if (!options.batch.empty()) found.push_back(server.json("GET", "/v1/batches/" + options.batch));
    for (const std::string& id : options.ids) found.push_back(server.json("GET", "/v1/bakes/" + id));
    if (!found.empty()) return found;
    const Json page =
        server.json("GET", "/v1/bakes?limit=20" + (options.state.empty() ? "" : "&state=" + options.state));
    for (const Json& view : page.at("bakes")) found.push_back(view);
    return found;
}

void run_status(const StatusOptions& options) {
    check_ids(options.ids, "id");
    if (!options.batch.empty()) check_ids({options.batch}, "batch");
    std::vector<std::string> lines;
    run_phase(options.connection, server_options(options.connection), {}, [&](Server& server) {
        for (const Json& view : views(server, options))
            lines.push_back(options.json || options.connection.json()
                                ? view.dump(-1, ' ', false, Json::error_handler_t::replace)
                            : view.contains("states") ? batch_line(view)
                                                      : line_of(view));
    });
    for (const std::string& line : lines) print_line(line);
}

/// A bake that is cancelled already is no error.
void cancel(Server& server, const std::string& id) {
    const HttpAnswer answer = server.ask({.method = "DELETE", .path = "/v1/bakes/" + id});
    if (answer.status == 409 && server.json("GET", "/v1/bakes/" + id).at("state") == "cancelled") return;
    if (answer.status != 200) refuse(answer);
}

void run_cancel(const StatusOptions& options) {
    check_ids_or_batch(options.ids, options.batch, "cancel");
    std::vector<std::string> ids = options.ids;
    run_phase(options.connection, server_options(options.connection), {}, [&](Server& server) {
        for (const char* state : {"queued", "running"})
            if (!options.batch.empty())
                for (std::string& id : bakes_of_batch(server, options.batch, state)) ids.push_back(std::move(id));
        for (const std::string& id : ids) cancel(server, id);
    });
    for (const std::string& id : ids)
        print_line(options.connection.json() ? R"({"event":"cancelled","id":)" + json_string(id) + "}"
                                             : id + " cancelled");
}

}  // namespace

void add_status_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("status", "Show the states of bakes on a service");
    const auto options = std::make_shared<StatusOptions>();
    command->add_option("id", options->ids, "ids of bakes; default: the 20 newest")->type_name("ID");
    command->add_option("--batch", options->batch, "id of a batch, as rebake prints it: shows its counts")
        ->type_name("ID");
    command->add_option("--state", options->state, "of the newest, only those in this state")
        ->check(one_of({"queued", "running", "done", "failed", "cancelled"}));
    command->add_flag("--json", options->json, "the server's answers, one JSON object per line");
    add_connection_flags(*command, options->connection);
    command->callback([options, &action] {
        action = [options] { with_json_failures(options->connection.progress, [&] { run_status(*options); }); };
    });
}

void add_cancel_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("cancel", "Cancel bakes on a service");
    const auto options = std::make_shared<StatusOptions>();
    command->add_option("id", options->ids, "ids of bakes, as submit prints them")->type_name("ID");
    command->add_option("--batch", options->batch, "all bakes of a batch that have not ended")->type_name("ID");
    add_connection_flags(*command, options->connection);
    command->callback([options, &action] {
        action = [options] { with_json_failures(options->connection.progress, [&] { run_cancel(*options); }); };
    });
}

}  // namespace hairbake
