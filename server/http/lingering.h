// Closing of connections whose clients still send, without a thread for each.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <deque>
#include <mutex>
#include <thread>

namespace hairbake {

/// After a reply to a request that was not read to its end, the bytes that still come must be read for a while:
/// otherwise a connection reset could destroy the reply. One thread does this for all connections. Thread-safe.
class Lingering {
public:
    /// A connection is closed after `patience`, after 16 MiB, when its client closes it, or when `most` newer ones
    /// came.
    Lingering(std::chrono::milliseconds patience, std::size_t most);
    /// Closes all.
    ~Lingering();

    /// Shuts down sending, and takes over the socket.
    void add(int socket);

private:
    using Clock = std::chrono::steady_clock;
    /// Owns the socket.
    struct Held {
        Held(int connection, Clock::time_point close_at) : socket(connection), end(close_at) {}
        ~Held();
        Held(Held&& other) noexcept;
        Held& operator=(Held&& other) noexcept;

        int socket;
        Clock::time_point end;
        std::size_t read = 0;
    };

    void run();
    bool still_sends(Held& held) const;

    const std::chrono::milliseconds patience_;
    const std::size_t most_;
    const int wake_;    ///< an eventfd: a connection was added, or the end has come
    std::mutex mutex_;  ///< guards the next member
    std::deque<Held> added_;
    std::atomic<bool> ending_ = false;
    std::jthread thread_;  ///< the last member: it uses the others
};

}  // namespace hairbake
