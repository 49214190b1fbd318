// hairbake delete
#include <CLI/CLI.hpp>
#include <algorithm>

#include "clients/cli/commands.h"
#include "clients/cli/option_values.h"
#include "clients/cli/output.h"
#include "clients/cli/remote/outcome.h"

namespace hairbake {
namespace {

struct DeleteOptions {
    ConnectionFlags connection;
    std::vector<std::string> inputs;
    std::string kind;
    bool force = false;
};

/// The digest of "sha256:DIGEST".
/// Throws Error(usage).
std::string digest_of(const std::string& input) {
    constexpr std::string_view prefix = "sha256:";
    const std::string digest = input.starts_with(prefix) ? input.substr(prefix.size()) : "";
    const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
    if (digest.size() != 64 || !std::all_of(digest.begin(), digest.end(), is_digit))
        throw Error(ErrorKind::usage,
                    "input is " + input + "; allowed is sha256:DIGEST with 64 hexadecimal digits, as upload prints it",
                    "input");
    return digest;
}

std::string address_of(const std::string& kind, const std::string& digest) {
    const bool is_listed = kind == "model" || kind == "environment";
    return "/v1/" + (is_listed ? kind + "s" : "blobs") + "/" + digest;
}

void run(const DeleteOptions& options) {
    std::vector<std::string> digests;
    for (const std::string& input : options.inputs) digests.push_back(digest_of(input));
    run_phase(options.connection, server_options(options.connection), {}, [&](Server& server) {
        for (const std::string& digest : digests) {
            const std::string path = address_of(options.kind, digest) + (options.force ? "?force=1" : "");
            const HttpAnswer answer = server.ask({.method = "DELETE", .path = path});
            if (answer.status != 204) refuse(answer);
            print_line(options.connection.json()
                           ? R"({"event":"deleted","reference":)" + json_string("sha256:" + digest) + "}"
                           : "sha256:" + digest + " deleted");
        }
    });
}

}  // namespace

void add_delete_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("delete", "Delete inputs from a service");
    const auto options = std::make_shared<DeleteOptions>();
    command->add_option("input", options->inputs, "sha256:DIGEST, as upload prints it")->required()->type_name("INPUT");
    command
        ->add_option("--as", options->kind,
                     "model or environment: the service lists it; mesh: it was sent only (default)")
        ->check(one_of({"model", "environment", "mesh"}));
    command->add_flag("--force", options->force,
                      "also if done bakes or versions of names refer to it; without it they are listed");
    command->footer("Results that were baked from an input stay.\n\n");
    add_connection_flags(*command, options->connection);
    command->callback([options, &action] {
        action = [options] { with_json_failures(options->connection.progress, [&] { run(*options); }); };
    });
}

}  // namespace hairbake
