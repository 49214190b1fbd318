// The service as the commands use it: calls with retries, refusals as messages, JSON answers.
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

/// Waits between retries, longer each time (0.1 s to 5 s), until `seconds` have passed.
class Patience {
public:
    Patience(double seconds, Progress& progress) : seconds_(seconds), progress_(progress) {}

    /// Call it after a failed attempt. Warns the first time.
    /// Throws `lost` when `seconds` have passed since the first failure after the last renew().
    /// Throws Error(cancelled).
    void wait(const ConnectionLost& lost);
    /// Starts the time again, after progress was made.
    void renew();

private:
    double seconds_;
    Progress& progress_;
    double failing_since_ = -1, pause_ = 0;
};

/// Sleeps.
/// Throws Error(cancelled) within 50 ms of a cancel.
void pause(double seconds, const Progress& progress);

/// `text` for a terminal or a log: control characters become '?', and the text is cut after 1,000 bytes.
std::string plain(const std::string& text);

class Server {
public:
    using Json = nlohmann::ordered_json;

    Server(const ServerOptions& options, BakeProgress& progress);

    /// One attempt.
    /// Throws the errors of HttpClient::send.
    /// Throws ConnectionLost also when the server is busy or its proxy does not reach it (408, 429, 502, 503, 504).
    HttpAnswer once(const HttpCall& call);
    /// once() with retries until the patience is used up.
    HttpAnswer ask(const HttpCall& call);
    /// Sends and receives JSON.
    /// Throws RemoteError(refused) unless the status is 2xx.
    Json json(const std::string& method, const std::string& path, const std::string& body = {});

    BakeProgress& progress() { return progress_; }
    Patience patience() { return {options_.patience_s, progress_}; }
    const std::string& url() const { return options_.url; }

private:
    ServerOptions options_;
    BakeProgress& progress_;
    HttpClient http_;
};

/// For an error answer.
/// Throws RemoteError(refused) with the server's message and the field at fault.
[[noreturn]] void refuse(const HttpAnswer& answer);

/// The body as JSON of at most 64 levels.
/// Throws RemoteError(refused).
Server::Json parse_json(const std::string& text);

/// Whether `text` has the form of an id of a bake, a batch or an upload: 1 to 128 letters, digits, '-' and '_'.
bool is_id(const std::string& text);

/// json[field]; empty if it is not a text.
std::string text_in(const Server::Json& json, const char* field);

/// json[field], an id.
/// Throws RemoteError(refused).
std::string id_in(const Server::Json& json, const char* field);

}  // namespace hairbake
