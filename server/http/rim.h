// The listening side. cpp-httplib is behind it and nowhere else.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "server/http/message.h"

namespace hairbake {

struct RimSettings {
    std::string socket;  ///< path of a Unix socket; when empty, address and port hold
    std::string address;
    int port = 0;  ///< 0: any free one
    int threads = 64, waiting = 256;
    std::string accel;  ///< location at which nginx sends the store's blobs; empty: the daemon sends them itself
};

/// One request a connection. What is malformed (framing, paths, control characters, encodings) is answered here with
/// problem+json and reaches no route. Thread-safe.
class Rim {
public:
    using Handler = std::function<HttpReply(HttpRequest&)>;

    /// Binds. Throws Error(usage) when the place is taken or not allowed.
    Rim(const RimSettings& settings, Handler handler);
    ~Rim();

    /// "http://127.0.0.1:8080" or "unix:/run/hairbaked.sock".
    std::string address() const;
    /// Serves until stop() is called from another thread, or no connection can be accepted any more.
    void serve();
    /// Before serve() too.
    void stop();

private:
    class Listener;
    std::unique_ptr<Listener> listener_;
};

}  // namespace hairbake
