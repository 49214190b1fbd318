// The table of routes, and the search for the route of a request.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/http/access.h"
#include "server/http/body_places.h"
#include "server/http/message.h"
#include "server/http/place_times.h"

namespace hairbake {

struct Route {
    std::string method;   ///< a GET also answers HEAD unless HEAD has a row of its own
    std::string pattern;  ///< "/v1/bakes/{id}"; "{path...}" matches all remaining segments
    Scope scope = Scope::admin;
    std::uint64_t body_limit = 0;  ///< bytes; 0: the route takes no body
    std::function<HttpReply(HttpRequest&)> handle;
    /// Allowed media types of the body; a body without Content-Type is taken as any of them. Empty: the handler checks.
    std::vector<std::string> types = {};
    bool takes_place = false;  ///< of BodyPlaces, for each body: nginx forwards it while it arrives
};

/// Thread-safe.
class Router {
public:
    Router(std::vector<Route> routes, Access& access, BodyPlaces& places)
        : routes_(std::move(routes)), access_(access), places_(places) {}

    /// Finds the route, checks access and the body's framing, limit, type and place, and calls the handler. Answers
    /// 404, 405, 429 and OPTIONS itself. All failures become problem+json.
    HttpReply answer(HttpRequest& request) const;

    const std::vector<Route>& routes() const { return routes_; }

private:
    HttpReply answer_or_throw(HttpRequest& request) const;

    std::vector<Route> routes_;
    Access& access_;
    BodyPlaces& places_;
    std::unique_ptr<PlaceTimes> times_ = std::make_unique<PlaceTimes>();
};

}  // namespace hairbake
