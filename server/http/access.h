// Who may do what: tokens, browser sessions, and the checks that hold without tokens.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/http/message.h"
#include "server/settings.h"

namespace hairbake {

/// What a route asks for. `open` routes serve anybody who reaches the daemon.
enum class Scope { open, read, upload, bake, admin };
const char* name_of(Scope scope);

/// A refusal with 401 or 403.
class Denied : public std::exception {
public:
    explicit Denied(HttpReply reply) : reply_(std::move(reply)) {}
    const HttpReply& reply() const { return reply_; }
    const char* what() const noexcept override { return "denied"; }

private:
    HttpReply reply_;
};

/// Thread-safe.
class Access {
public:
    explicit Access(std::vector<TokenSettings> tokens) : tokens_(std::move(tokens)) {}

    /// Sets request.caller, or throws Denied. Without tokens in the configuration everything is allowed to who names a
    /// loopback host in Host and, if at all, in Origin: a page of another site that had its name point to 127.0.0.1
    /// cannot do that; what a proxy forwards is refused, even what is open. With tokens: `Authorization: Bearer`, or
    /// the cookie of a session. A scope is not implied by another, but admin implies all.
    void check(HttpRequest& request, Scope scope);

    /// Exchanges the request's bearer token for a session of twelve hours; the value of Set-Cookie. Throws Denied.
    std::string open_session(const HttpRequest& request);
    /// Ends the request's session; the value of Set-Cookie.
    std::string close_session(const HttpRequest& request);

private:
    struct Session {
        std::size_t token = 0;
        double expires = 0;
    };
    std::optional<std::size_t> token_of(const HttpRequest& request);
    std::optional<std::size_t> find_token(const std::string& text) const;
    void check_origin(const HttpRequest& request) const;

    const std::vector<TokenSettings> tokens_;
    std::mutex mutex_;
    std::map<std::string, Session> sessions_;  ///< by the digest of the cookie
};

/// A new token, 43 characters of base64url (256 random bits).
std::string new_token();

}  // namespace hairbake
