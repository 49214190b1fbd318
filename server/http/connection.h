// An accepted connection, buffered so that a short request and its reply need few system calls.
#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>

namespace hairbake {

/// For one thread. Owns the socket and closes it. Written bytes are buffered until they fill a packet, something is
/// read, or flush() is called, so that a reply's head and body leave together.
class Connection {
public:
    struct Patience {
        std::chrono::milliseconds head, read, write;  ///< how long to wait for the client; `head`: for a whole one
    };

    Connection(int socket, const Patience& patience);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    int socket() const { return socket_; }
    const Patience& patience() const { return patience_; }
    /// Waits for bytes of the request's head, unless some are unread. Returns false when the client has closed, when
    /// the patience for the whole head has ended since the construction, or soon after `still_wanted` returns false.
    bool await_head(const std::function<bool()>& still_wanted);
    /// The same for bytes that come later, with the patience for a read.
    bool await_more(const std::function<bool()>& still_wanted);
    /// Returns the number of bytes read, 1 to `size`; 0 when the client has closed; -1 after an error or a timeout.
    ssize_t read(char* data, std::size_t size);
    /// Returns `size`, or -1 when buffered bytes cannot be sent.
    ssize_t write(const char* data, std::size_t size);
    bool flush();
    /// Whether bytes were received that nobody has read.
    bool has_unread() const { return ahead_begin_ < ahead_end_; }
    /// Whether await_head() or await_more() found that the client has closed.
    bool is_closed() const { return is_closed_; }
    /// Whether bytes can be read, or written, before the patience ends.
    bool await_readable() const;
    bool await_writable() const;

    /// Gives up the socket: the caller closes it. Nothing else may be called afterwards.
    int release() { return std::exchange(socket_, -1); }

private:
    using Clock = std::chrono::steady_clock;
    bool await(short event, std::chrono::milliseconds patience) const;
    bool fill(const std::function<bool()>& still_wanted, Clock::time_point end);
    ssize_t receive(char* data, std::size_t size) const;
    ssize_t send(const char* data, std::size_t size) const;
    bool send_all(const char* data, std::size_t size) const;

    int socket_;
    const Patience patience_;
    const Clock::time_point head_end_;
    std::array<char, 4096> ahead_;                 ///< read buffer
    std::size_t ahead_begin_ = 0, ahead_end_ = 0;  ///< the unread bytes in it
    bool is_closed_ = false;
    std::string held_;  ///< write buffer
};

}  // namespace hairbake
