// The service as the commands see it: calls that outlast a lost connection, refusals in words, JSON answers.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "clients/cli/remote/http_client.h"
#include "core/base/progress.h"

namespace hairbake {

struct ServerOptions {
    std::string url, token, ca_file;
    double patience_s = 120;
};

/// Waits between attempts, longer each time (0.1 s to 5 s), until the patience is over.
class Patience {
public:
    Patience(double seconds, Progress& progress) : seconds_(seconds), progress_(progress) {}

    /// After a failed attempt. Says so the first time; throws `lost` when `seconds` have passed since the first failure
    /// after the last renew(), Error(cancelled) when asked to stop.
    void wait(const ConnectionLost& lost);
    /// Something was achieved: the time counts anew.
    void renew();

private:
    double seconds_;
    Progress& progress_;
    double failing_since_ = -1, pause_ = 0;
};

/// Sleeps; throws Error(cancelled) within 50 ms of a cancel.
void pause(double seconds, const Progress& progress);

/// `text` for a terminal or a log: control characters become '?', and what is longer than 1,000 bytes is cut.
std::string plain(const std::string& text);

class Server {
public:
    using Json = nlohmann::ordered_json;

    Server(const ServerOptions& options, BakeProgress& progress);

    /// One attempt. Throws as HttpClient::send; a server that is busy or has nothing behind its proxy (429, 502, 503,
    /// 504) is ConnectionLost too.
    HttpAnswer once(const HttpCall& call);
    /// The same with patience.
    HttpAnswer ask(const HttpCall& call);
    /// JSON there and back; throws RemoteError(refused) unless the status is 2xx.
    Json json(const std::string& method, const std::string& path, const std::string& body = {});

    BakeProgress& progress() { return progress_; }
    Patience patience() { return {options_.patience_s, progress_}; }
    const std::string& url() const { return options_.url; }

private:
    ServerOptions options_;
    BakeProgress& progress_;
    HttpClient http_;
};

/// Throws the RemoteError(refused) for an answer that is no success: the server's words and the field at fault.
[[noreturn]] void refuse(const HttpAnswer& answer);

/// The body as JSON of at most 64 levels. Throws RemoteError(refused).
Server::Json parse_json(const std::string& text);

/// What the server calls a bake, a batch or an upload, fit for an address: letters, digits, '-', '_', at most 128 of
/// them.
bool is_id(const std::string& text);

/// json[field]; empty where there is no text.
std::string text_in(const Server::Json& json, const char* field);

/// json[field], an id. Throws RemoteError(refused).
std::string id_in(const Server::Json& json, const char* field);

}  // namespace hairbake
