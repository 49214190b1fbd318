// The bytes of one request from its connection, and when a slow client is given up.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "server/http/body_pace.h"
#include "server/http/connection.h"

namespace hairbake {

/// For one thread. The connection must outlive it.
class RequestReader {
public:
    /// `keeps_thread` tells whether the client may still let this thread wait for a head or a short body.
    RequestReader(Connection& connection, const BodyPace::Limits& pace, std::function<bool()> keeps_thread);

    /// As Connection::read(). -1 also for a head that is too long, and when the client is given up.
    ssize_t read(char* data, std::size_t size);

    /// What is read from now on is the body.
    ///
    /// `client_waits`: it sends its body only after a reply "100 Continue". The reply goes out when the body is read
    /// for the first time, so a request that is refused by its head gets its refusal alone.
    /// `is_short`: a body that has no place, so it must not keep a thread from others.
    void end_head(bool client_waits, bool is_short);
    bool in_head() const { return in_head_; }

    /// Why the client was given up, for people; empty while it is not.
    const std::string& given_up() const { return given_up_; }

private:
    bool send_continue();
    ssize_t read_head(char* data, std::size_t size);
    ssize_t read_body(char* data, std::size_t size);

    Connection& connection_;
    BodyPace pace_;
    const std::function<bool()> keeps_thread_;
    bool in_head_ = true, client_waits_ = false, is_short_ = false;
    std::size_t head_bytes_ = 0;
    std::string given_up_;
};

}  // namespace hairbake
