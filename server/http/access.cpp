#include "server/http/access.h"

#include <openssl/crypto.h>
#include <sys/random.h>

#include <algorithm>
#include <array>

#include "core/base/digest.h"
#include "core/base/error.h"
#include "core/base/short_text.h"
#include "server/http/problem.h"
#include "server/jobs/service.h"

namespace hairbake {
namespace {

constexpr double session_s = 12 * 3600;
constexpr std::size_t most_sessions = 1'000, longest_token = 200;  // sessions of one token
const std::string cookie_name = "hairbake_session";

constexpr std::size_t longest_shown = 200;  // of a header

std::string quoted(const std::string& text) { return hairbake::quoted(text, longest_shown); }

std::string list_of(const std::set<Scope>& scopes) {
    std::string list;
    for (const Scope scope : scopes) list += (list.empty() ? "" : ", ") + name_of(scope);
    return list;
}

[[noreturn]] void deny(int status, const std::string& slug, const std::string& words) {
    HttpReply reply = problem(status, slug, words);
    if (status == 401) reply.with("WWW-Authenticate", "Bearer realm=\"hairbake\"");
    throw Denied(std::move(reply));
}

/// "[::1]:8080" -> "[::1]".
std::string without_port(const std::string& host) {
    const std::size_t colon = host.rfind(':');
    return colon == std::string::npos || host.ends_with("]") ? host : host.substr(0, colon);
}

bool is_loopback(const std::string& host) {
    const std::string name = without_port(host);
    return name == "localhost" || name == "127.0.0.1" || name == "[::1]";
}

/// "http://localhost:8080" -> "localhost:8080".
std::string host_of(const std::string& origin) {
    const std::size_t slashes = origin.find("://");
    return slashes == std::string::npos ? "" : origin.substr(slashes + 3);
}

std::optional<std::string> bearer_of(const HttpRequest& request) {
    const auto header = request.header("Authorization");
    if (!header || !header->starts_with("Bearer ") || header->size() > longest_token) return std::nullopt;
    return header->substr(7);
}

std::optional<std::string> cookie_of(const HttpRequest& request) {
    const std::string cookies = request.header("Cookie").value_or("");
    for (std::size_t begin = 0; begin < cookies.size();) {
        const std::size_t end = std::min(cookies.find(';', begin), cookies.size());
        std::string pair = cookies.substr(begin, end - begin);
        pair.erase(0, std::min(pair.find_first_not_of(' '), pair.size()));
        if (pair.starts_with(cookie_name + "=")) return pair.substr(cookie_name.size() + 1);
        begin = end + 1;
    }
    return std::nullopt;
}

[[noreturn]] void deny_without_token(const HttpRequest& request) {
    const char* const found = request.header("Authorization") ? "the header Authorization has no valid token"
                              : cookie_of(request)            ? "the session has ended"
                                                              : "the request has no token";
    deny(401, "unauthorized",
         std::string(found) +
             "; needed is Authorization: Bearer TOKEN, with a token ([[token]]) of the daemon's "
             "configuration that has not expired");
}

}  // namespace

std::optional<std::size_t> Access::find_token(const std::string& text) const {
    const std::string digest = Digest().add(text).hex();
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < tokens_.size(); ++i) {  // all of them, so that the time tells nothing
        const std::string& known = tokens_[i].sha256;
        if (known.size() == digest.size() && CRYPTO_memcmp(known.data(), digest.data(), digest.size()) == 0) found = i;
    }
    if (found && tokens_[*found].expires && *tokens_[*found].expires < now()) return std::nullopt;
    return found;
}

std::optional<std::size_t> Access::token_of(const HttpRequest& request) {
    if (const auto bearer = bearer_of(request)) return find_token(*bearer);
    const auto cookie = cookie_of(request);
    if (!cookie) return std::nullopt;
    check_origin(request);
    const std::lock_guard lock(mutex_);
    const auto session = sessions_.find(Digest().add(*cookie).hex());
    if (session == sessions_.end() || session->second.expires < now()) return std::nullopt;
    const TokenSettings& token = tokens_[session->second.token];
    if (token.expires && *token.expires < now()) return std::nullopt;
    return session->second.token;
}

/// A browser sends the page's origin with every request that changes something; it must be this service.
void Access::check_origin(const HttpRequest& request) const {
    const auto origin = request.header("Origin");
    const std::string host = request.header("Host").value_or("");
    if (origin && host_of(*origin) != host)
        deny(403, "foreign-origin",
             "the header Origin is " + quoted(*origin) + ", a page of another site; allowed is the address in Host, " +
                 quoted(host) +
                 ". Use the service's own page, or a program that sends no Origin. A proxy must pass Host on as it "
                 "came (proxy_set_header Host $http_host)");
}

void Access::check(HttpRequest& request, Scope scope) {
    if (tokens_.empty() && is_forwarded(request))
        deny(403, "no-tokens",
             "a proxy forwarded the request (it has the header X-Forwarded-For), and a daemon without tokens in its "
             "configuration answers its own machine alone. Ask the daemon directly, or configure a token ([[token]]): "
             "`hairbaked token new` makes one");
    if (scope == Scope::open) return;
    if (tokens_.empty()) {
        if (!is_loopback(request.header("Host").value_or("")))
            deny(403, "no-tokens",
                 "the header Host is " + quoted(request.header("Host").value_or("")) +
                     "; allowed are localhost, 127.0.0.1 and [::1], with any port: a daemon without tokens in its "
                     "configuration answers its own machine alone. Ask by one of these names, or configure a token "
                     "([[token]]): `hairbaked token new` makes one");
        check_origin(request);
        request.caller = "local";
        return;
    }
    const auto token = token_of(request);
    if (!token) deny_without_token(request);
    const std::set<Scope>& scopes = tokens_[*token].scopes;
    if (!scopes.count(scope) && !scopes.count(Scope::admin))
        deny(403, "forbidden",
             "the token " + quoted(tokens_[*token].name) + " has the scopes " + list_of(scopes) + "; needed is " +
                 name_of(scope) +
                 " or admin: use another token, or add the scope to this [[token]] of the daemon's "
                 "configuration");
    request.caller = tokens_[*token].name;
}

std::string Access::open_session(const HttpRequest& request) {
    if (tokens_.empty())
        deny(403, "no-tokens", "the daemon has no tokens in its configuration ([[token]]): no session is needed");
    const auto bearer = bearer_of(request);
    const auto token = bearer ? find_token(*bearer) : std::nullopt;
    if (!token) deny_without_token(request);
    const std::string cookie = new_token();
    const std::lock_guard lock(mutex_);
    std::erase_if(sessions_, [time = now()](const auto& session) { return session.second.expires < time; });
    const auto of_token = [&](const auto& session) { return session.second.token == *token; };
    if (std::count_if(sessions_.begin(), sessions_.end(), of_token) >= std::ptrdiff_t(most_sessions)) {
        auto oldest = sessions_.end();
        for (auto session = sessions_.begin(); session != sessions_.end(); ++session)
            if (of_token(*session) && (oldest == sessions_.end() || session->second.expires < oldest->second.expires))
                oldest = session;
        sessions_.erase(oldest);
    }
    sessions_[Digest().add(cookie).hex()] = {*token, now() + session_s};
    return cookie_name + "=" + cookie +
           "; Path=/; HttpOnly; SameSite=Strict; Max-Age=" + std::to_string(int(session_s));
}

std::string Access::close_session(const HttpRequest& request) {
    if (const auto cookie = cookie_of(request)) {
        check_origin(request);
        const std::lock_guard lock(mutex_);
        sessions_.erase(Digest().add(*cookie).hex());
    }
    return cookie_name + "=; Path=/; HttpOnly; SameSite=Strict; Max-Age=0";
}

std::string new_token() {
    std::array<unsigned char, 32> bits{};
    if (::getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size()))
        throw Error(ErrorKind::internal, "the kernel gives no random bytes");
    constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    std::string token;
    unsigned buffer = 0;
    int held = 0;
    for (const unsigned char byte : bits) {
        buffer = buffer << 8 | byte;
        for (held += 8; held >= 6; held -= 6) token += letters[buffer >> (held - 6) & 63];
    }
    return token + letters[buffer << (6 - held) & 63];
}

}  // namespace hairbake
