// The table of routes and what finds a request's row in it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "server/http/access.h"
#include "server/http/message.h"

namespace hairbake {

struct Route {
    std::string method;   ///< a GET also answers HEAD unless HEAD has a row of its own
    std::string pattern;  ///< "/v1/bakes/{id}"; "{path...}" takes all segments that are left
    Scope scope = Scope::admin;
    std::uint64_t body_limit = 0;  ///< bytes; 0: no body is taken
    std::function<HttpReply(HttpRequest&)> handle;
    /// Media types of the body; a body without Content-Type passes for any. None: the handler looks for itself.
    std::vector<std::string> types = {};
};

/// Thread-safe.
class Router {
public:
    Router(std::vector<Route> routes, Access& access) : routes_(std::move(routes)), access_(access) {}

    /// Access, the body's framing, limit and type, handler; 404, 405 with Allow, OPTIONS; every failure as
    /// problem+json.
    HttpReply answer(HttpRequest& request) const;

    const std::vector<Route>& routes() const { return routes_; }

private:
    HttpReply answer_or_throw(HttpRequest& request) const;

    std::vector<Route> routes_;
    Access& access_;
};

}  // namespace hairbake
