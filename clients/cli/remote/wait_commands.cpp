// hairbake wait, hairbake fetch
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "clients/cli/commands.h"
#include "clients/cli/output.h"
#include "clients/cli/remote/fetch.h"
#include "clients/cli/remote/outcome.h"
#include "clients/cli/remote/result_warnings.h"
#include "core/bake.h"

namespace hairbake {
namespace {

struct WaitOptions {
    ConnectionFlags connection;
    std::vector<std::string> ids;
    std::string batch;
};

void run_wait(const WaitOptions& options) {
    check_ids_or_batch(options.ids, options.batch, "wait");
    Awaited awaited;
    awaited.which = options.batch.empty() ? "" : "--batch " + options.batch;
    for (const std::string& id : options.ids) awaited.which += (awaited.which.empty() ? "" : " ") + id;
    awaited.wait = [&](Server& server) {
        return options.batch.empty() ? wait_for_bakes(server, options.ids) : wait_for_batch(server, options.batch);
    };
    await_bakes(options.connection, server_options(options.connection), awaited);
}

struct FetchOptions {
    ConnectionFlags connection;
    std::string id, folder;
};

void run_fetch(const FetchOptions& options) {
    check_ids({options.id}, "id");
    prove_writable(options.folder);
    Fetched fetched;
    run_phase(options.connection, server_options(options.connection), {{"fetch", 1}},
              [&](Server& server) { fetched = fetch_result(server, options.id, options.folder); });
    say_bake_warnings("", fetched.warnings);
    if (options.connection.json())
        print_line(Server::Json{{"event", "done"},
                                {"id", options.id},
                                {"folder", options.folder},
                                {"received_bytes", fetched.received},
                                {"warnings", fetched.warnings}}
                       .dump(-1, ' ', false, Server::Json::error_handler_t::replace));
    else
        print_line(options.folder + ": " + std::to_string(fetched.files) + " files, " + in_megabytes(fetched.bytes) +
                   ", " + in_megabytes(fetched.received) + " of it received");
}

}  // namespace

void add_wait_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("wait", "Wait until bakes on a service have ended");
    const auto options = std::make_shared<WaitOptions>();
    command->add_option("id", options->ids, "ids of bakes, as submit prints them")->type_name("ID");
    command->add_option("--batch", options->batch, "id of a batch, as rebake prints it: all its bakes")
        ->type_name("ID");
    add_connection_flags(*command, options->connection);
    command->callback([options, &action] {
        action = [options] { with_json_failures(options->connection.progress, [&] { run_wait(*options); }); };
    });
}

void add_fetch_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("fetch", "Fetch the result of a bake that is done");
    const auto options = std::make_shared<FetchOptions>();
    command->add_option("id", options->id, "id of the bake")->required()->type_name("ID");
    command->add_option("--out", options->folder, "result folder: new, empty or an earlier result")
        ->required()
        ->type_name("DIR");
    add_connection_flags(*command, options->connection);
    command->callback([options, &action] {
        action = [options] { with_json_failures(options->connection.progress, [&] { run_fetch(*options); }); };
    });
}

}  // namespace hairbake
