// Access control: tokens, browser sessions, and the checks of a service without tokens.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/http/message.h"
#include "server/settings.h"

namespace hairbake {

/// The exception for a reply of 401 or 403.
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

    /// Checks the request and sets request.caller.
    ///
    /// With tokens in the configuration, a request needs `Authorization: Bearer` or the cookie of a session, and the
    /// token needs the scope. No scope implies another one, but admin implies all.
    /// Without tokens, the headers Host and Origin must name a loopback host: a page of another site whose name was
    /// pointed to 127.0.0.1 cannot send these. Requests that a proxy forwards are refused, even for open routes.
    /// Throws Denied.
    void check(HttpRequest& request, Scope scope);

    /// Exchanges the request's bearer token for a session of twelve hours. Returns the value of Set-Cookie.
    /// Throws Denied.
    std::string open_session(const HttpRequest& request);
    /// Ends the request's session. Returns the value of Set-Cookie.
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
