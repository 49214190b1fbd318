#include "clients/cli/remote/connection_flags.h"

#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "clients/cli/common_flags.h"
#include "clients/cli/messages.h"
#include "clients/cli/option_values.h"
#include "clients/cli/signal_watch.h"
#include "core/base/json_reason.h"

namespace hairbake {
namespace {

constexpr std::size_t longest_token = 4096;

std::string read_token(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(ErrorKind::bad_input, file + ": " + std::generic_category().message(errno), "token-file");
    std::string token(longest_token + 1, '\0');
    stream.read(token.data(), static_cast<std::streamsize>(token.size()));
    if (stream.bad())
        throw Error(ErrorKind::bad_input, file + ": " + std::generic_category().message(errno), "token-file");
    token.resize(static_cast<std::size_t>(stream.gcount()));
    token.erase(token.find_last_not_of(" \t\r\n") + 1);
    const auto allowed = [](unsigned char c) { return c > 0x20 && c < 0x7f; };
    if (token.empty() || token.size() > longest_token || !std::all_of(token.begin(), token.end(), allowed))
        throw Error(ErrorKind::bad_input,
                    file + " is not a token: one word of up to " + std::to_string(longest_token) + " printable bytes",
                    "token-file");
    struct stat facts {};
    if (::stat(file.c_str(), &facts) == 0 && (facts.st_mode & S_IROTH))
        say_warning(file + " can be read by everybody on this machine; chmod 600 makes it yours alone");
    return token;
}

/// "host" of "http://host:port/base".
std::string host_of(const std::string& url) {
    const std::size_t begin = url.find("//") + 2;
    const std::size_t end = url[begin] == '[' ? url.find(']', begin) + 1 : url.find_first_of(":/", begin);
    return url.substr(begin, end - begin);
}

bool is_this_machine(const std::string& host) {
    return host == "localhost" || host == "[::1]" || host.starts_with("127.");
}

}  // namespace

void add_connection_flags(CLI::App& command, ConnectionFlags& flags) {
    command.add_option("--server", flags.server, "address of the service: http://HOST:PORT or https://HOST")
        ->envname("HAIRBAKE_SERVER")
        ->required()
        ->type_name("URL");
    command.add_option("--token-file", flags.token_file, "file with the token")
        ->envname("HAIRBAKE_TOKEN_FILE")
        ->type_name("FILE");
    command.add_option("--ca-file", flags.ca_file, "certificates (PEM) to trust instead of the system's")
        ->type_name("FILE");
    command.add_option("--patience", flags.patience_s, "seconds of retries while the server cannot be reached")
        ->transform(number(0, 86400))
        ->type_name("S")
        ->capture_default_str();
    add_progress_flag(command, flags.progress);
    command.footer(remote_exit_code_help());
}

ServerOptions server_options(const ConnectionFlags& flags) {
    ServerOptions options{flags.server, "", flags.ca_file, flags.patience_s};
    std::string& url = options.url;
    while (url.ends_with('/')) url.pop_back();
    const bool http = url.starts_with("http://"), https = url.starts_with("https://");
    if ((!http && !https) || url.find_first_of("@?#\\ ") != std::string::npos || host_of(url).empty())
        throw Error(ErrorKind::usage, "server is " + flags.server + "; allowed is http://HOST:PORT or https://HOST",
                    "server");
    if (!flags.ca_file.empty() && !std::ifstream(flags.ca_file))
        throw Error(ErrorKind::bad_input, flags.ca_file + ": " + std::generic_category().message(errno), "ca-file");
    if (!flags.token_file.empty()) options.token = read_token(flags.token_file);
    if (!options.token.empty() && http && !is_this_machine(host_of(url)))
        say_warning("the token goes over the network in the clear; https:// protects it");
    return options;
}

void run_phase(const ConnectionFlags& flags, const ServerOptions& options, const std::vector<Phase>& phases,
               const std::function<void(Server&)>& work) {
    const auto progress = make_progress_display(flags.progress, phases);
    const SignalWatch watch(*progress, [] {});
    Server server(options, *progress);
    try {
        work(server);
    } catch (const nlohmann::json::exception& surprise) {
        throw RemoteError(ExitCode::refused, "the server's answer has an unexpected form: " + json_reason(surprise));
    }
}

void check_ids(const std::vector<std::string>& ids, const char* field) {
    for (const std::string& id : ids)
        if (!is_id(id)) throw Error(ErrorKind::usage, plain(id) + " is not an id of the service", field);
}

void check_ids_or_batch(const std::vector<std::string>& ids, const std::string& batch, const std::string& command) {
    check_ids(ids, "id");
    if (!batch.empty()) check_ids({batch}, "batch");
    if (ids.empty() == batch.empty()) throw Error(ErrorKind::usage, command + " needs ids of bakes, or --batch", "id");
}

}  // namespace hairbake
