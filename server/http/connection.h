// One accepted connection: its bytes in and out, with as few calls of the system as a single request needs.
#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace hairbake {

/// For one thread. Owns the socket and closes it. What is written is held back until it is worth a packet, something
/// is read, or flush() is called: a reply's head and body, written one by one, leave together.
class Connection {
public:
    struct Patience {
        std::chrono::milliseconds first_byte, read, write;  ///< how long the client may stay silent, or not read
    };

    Connection(int socket, const Patience& patience);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    int socket() const { return socket_; }
    /// Waits for the first bytes; gives up when patience ends, or a moment after `still_wanted` says no.
    bool await_request(const std::function<bool()>& still_wanted);
    /// 1 to `size` bytes; 0: the client has closed; -1: it is gone, or was silent for too long.
    ssize_t read(char* data, std::size_t size);
    /// `size`, or -1 when what was held back cannot be sent.
    ssize_t write(const char* data, std::size_t size);
    bool flush();
    /// Whether the client sends, or takes, bytes before patience ends.
    bool await_readable() const;
    bool await_writable() const;

    /// Says that no more will be sent, and reads away for so long what the client still sends, so that the reply is not
    /// lost in a connection reset.
    void linger(std::chrono::milliseconds patience) const;

private:
    bool await(short event, std::chrono::milliseconds patience) const;
    ssize_t receive(char* data, std::size_t size) const;
    ssize_t send(const char* data, std::size_t size) const;
    bool send_all(const char* data, std::size_t size) const;

    const int socket_;
    const Patience patience_;
    std::array<char, 4096> ahead_;                 ///< what was read ahead ...
    std::size_t ahead_begin_ = 0, ahead_end_ = 0;  ///< ... lies here in it
    std::string held_;                             ///< what was written and not sent
};

}  // namespace hairbake
