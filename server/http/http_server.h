// The HTTP server. Only its source file knows cpp-httplib.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/http/body_pace.h"
#include "server/http/message.h"

namespace hairbake {

struct HttpServerSettings {
    std::string socket;  ///< path of a Unix socket; when empty, address and port are used
    std::string address;
    int port = 0;  ///< 0: any free port
    int threads = 64, waiting = 256;
    std::string accel;        ///< nginx's location of the store's blobs; empty: the daemon sends them itself
    BodyPace::Limits pace{};  ///< of bodies
};

/// Answers one request a connection. Malformed requests (framing, paths, control characters, encodings) get
/// problem+json and reach no route. Thread-safe.
class HttpServer {
public:
    using Handler = std::function<HttpReply(HttpRequest&)>;

    /// Binds and serves from now on.
    /// Throws Error(usage) when the address is in use or not allowed.
    /// Throws std::system_error when the system gives no more threads.
    HttpServer(const HttpServerSettings& settings, Handler handler);
    ~HttpServer();

    /// "http://127.0.0.1:8080" or "unix:/run/hairbaked.sock".
    std::string address() const;
    /// Waits until stop() is called or no connection can be accepted any more, and all connections are served. Call it
    /// from one thread.
    void join();
    void stop();

private:
    class Listener;
    std::unique_ptr<Listener> listener_;
};

}  // namespace hairbake
