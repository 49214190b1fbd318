#include "server/http/router.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "core/base/short_text.h"
#include "server/http/problem.h"
#include "server/jobs/service.h"

namespace hairbake {
namespace {

using Parameters = std::map<std::string, std::string>;

/// The values of the pattern's {…}. Nothing when the path does not match.
std::optional<Parameters> match(std::string_view pattern, const std::vector<std::string>& path) {
    Parameters parameters;
    std::size_t segment = 0;
    for (std::size_t begin = 1; begin < pattern.size();) {
        const std::size_t end = std::min(pattern.find('/', begin), pattern.size());
        const std::string_view part = pattern.substr(begin, end - begin);
        if (segment == path.size()) return std::nullopt;
        if (part.ends_with("...}")) {
            std::string rest;
            for (; segment < path.size(); ++segment) rest += (rest.empty() ? "" : "/") + path[segment];
            parameters[std::string(part.substr(1, part.size() - 5))] = rest;
        } else if (part.starts_with("{")) {
            parameters[std::string(part.substr(1, part.size() - 2))] = path[segment++];
        } else if (part != path[segment++]) {
            return std::nullopt;
        }
        begin = end + 1;
    }
    if (segment != path.size()) return std::nullopt;
    return parameters;
}

/// The methods of all routes that match the path, for Allow.
std::string allowed_methods(const std::vector<Route>& routes, const std::vector<std::string>& path) {
    std::string list = "OPTIONS";
    const auto add = [&](const std::string& method) {
        if (list.find(method) == std::string::npos) list += ", " + method;
    };
    for (const Route& route : routes) {
        if (!match(route.pattern, path)) continue;
        add(route.method);
        if (route.method == "GET") add("HEAD");
    }
    return list;
}

const Route* find(const std::vector<Route>& routes, HttpRequest& request, const std::string& method) {
    for (const Route& route : routes) {
        if (route.method != method) continue;
        if (auto parameters = match(route.pattern, request.path)) {
            request.parameters = std::move(*parameters);
            return &route;
        }
    }
    return nullptr;
}

/// The body's media type without its parameters.
std::string type_of(const HttpRequest& request) {
    const std::string type = request.header("Content-Type").value_or("");
    return type.substr(0, type.find_first_of("; "));
}

/// The reply to a body that is wrong by its headers. Nothing when they are right.
/// Throws Refusal(too_large).
std::optional<HttpReply> wrong_body(const HttpRequest& request, const Route& route) {
    if (route.body_limit == 0) {
        if (request.has_body) throw Refusal(Refused::too_large, "this address takes no body");
        return std::nullopt;
    }
    if (!request.content_length && !request.has_body)
        return problem(411, "length-required", "the body's length is missing: Content-Length, or chunks");
    if (request.content_length.value_or(0) > route.body_limit)
        throw Refusal(Refused::too_large, "the body is " + std::to_string(*request.content_length) +
                                              " bytes long; allowed is up to " + std::to_string(route.body_limit));
    const std::string type = type_of(request);
    if (type.empty() || route.types.empty() || std::count(route.types.begin(), route.types.end(), type))
        return std::nullopt;
    std::string allowed;
    for (const std::string& known : route.types) allowed += (allowed.empty() ? "" : " or ") + known;
    return problem(415, "unsupported", "the body is " + shortened(type, 80) + "; allowed is " + allowed,
                   "Content-Type");
}

bool needs_place(const HttpRequest& request, const Route& route) {
    return route.takes_place || request.content_length.value_or(route.body_limit) > long_body;
}

}  // namespace

HttpReply Router::answer_or_throw(HttpRequest& request) const {
    const Route* route = find(routes_, request, request.method);
    if (!route && request.method == "HEAD") route = find(routes_, request, "GET");
    if (!route) {
        const std::string allowed = allowed_methods(routes_, request.path);
        if (allowed == "OPTIONS") return problem(404, "not-found", "there is nothing at this address");
        if (request.method != "OPTIONS")
            return problem(405, "method-not-allowed",
                           request.method + " is not for this address; allowed is " + allowed)
                .with("Allow", allowed);
        HttpReply reply;
        reply.status = 204;
        return reply.with("Allow", allowed);
    }
    access_.check(request, route->scope);
    if (std::optional<HttpReply> wrong = wrong_body(request, *route)) return *wrong;
    const bool is_placed = needs_place(request, *route);
    const std::string address = request.header("X-Forwarded-For").value_or("");
    const auto place = is_placed ? places_.take(address) : std::optional<BodyPlaces::Place>();
    if (is_placed && !place) {
        const std::string wait = std::to_string(times_->seconds_until_one_ends(address, PlaceTimes::Clock::now()));
        return problem(429, "too-many", places_.refusal(address) + ": try again in " + wait + " s")
            .with("Retry-After", wait);
    }
    const auto time = place ? times_->begin(address) : std::optional<PlaceTimes::Begun>();
    // The length of the body is limited here, for all handlers.
    const auto read = request.read_body;
    request.read_body = [read,
                         limit = route->body_limit](const std::function<void(std::span<const std::byte>)>& receiver) {
        std::uint64_t total = 0;
        read([&](std::span<const std::byte> bytes) {
            total += bytes.size();
            if (total > limit)
                throw Refusal(Refused::too_large, "the body is longer than " + std::to_string(limit) + " bytes");
            receiver(bytes);
        });
    };
    return route->handle(request);
}

HttpReply Router::answer(HttpRequest& request) const {
    try {
        return answer_or_throw(request);
    } catch (const Denied& denied) {
        return denied.reply();
    } catch (...) {
        return problem_of_current_exception();
    }
}

}  // namespace hairbake
