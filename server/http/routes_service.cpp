#include <iterator>
#include <nlohmann/json.hpp>

#include "core/base/short_text.h"
#include "core/request/stages.h"
#include "server/http/openapi.h"
#include "server/http/problem.h"
#include "server/http/replies.h"
#include "server/http/routes.h"
#include "server/http/target.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

HttpReply version() {
    Json algorithms = Json::object();
    for (const Stage& stage : stages()) algorithms[std::string(stage.name)] = stage.algorithm;
    return json_reply(
        200,
        Json{{"name", "hairbaked"}, {"version", HAIRBAKE_VERSION}, {"api", "v1"}, {"algorithms", algorithms}}.dump());
}

/// Whether the caller may know where the service has its files: it is on this machine, or has a token.
bool may_know_paths(Access& access, HttpRequest& request) try {
    if (is_forwarded(request)) access.check(request, Scope::read);
    return true;
} catch (const Denied&) {
    return false;
}

/// The texts of /readyz without the folders of the store and of the worker program.
std::string without_paths(std::string text, const Settings& settings) {
    replace_all(text, settings.store.string(), "the store");
    const std::string folder = settings.worker.parent_path().string();
    if (!folder.empty()) replace_all(text, folder + "/", "");
    return text;
}

HttpReply ready(Service& service, Access& access, HttpRequest& request) {
    const bool with_paths = may_know_paths(access, request);
    const auto shown = [&](const std::string& text) {
        return with_paths ? text : without_paths(text, service.settings());
    };
    const std::string wrong = service.not_ready();
    if (!wrong.empty())
        return problem(503, "not-ready", shown(wrong))
            .with("Retry-After", std::to_string(service.seconds_until_retry()));
    Json answer{{"status", "ready"}};
    for (const std::string& warning : service.warnings()) answer["warnings"].push_back(shown(warning));
    return json_reply(200, answer.dump());
}

HttpReply session(std::string cookie) {
    HttpReply reply;
    reply.status = 204;
    return reply.with("Set-Cookie", std::move(cookie)).with("Cache-Control", "no-store");
}

}  // namespace

std::int64_t number_in_query(const HttpRequest& request, const std::string& name, std::int64_t low, std::int64_t high,
                             std::int64_t otherwise) {
    const auto found = request.query.find(name);
    if (found == request.query.end()) return otherwise;
    const auto number = read_length(found->second);
    if (!number || *number > static_cast<std::uint64_t>(high) || static_cast<std::int64_t>(*number) < low)
        throw Refusal(Refused::unprocessable,
                      name + " is \"" + shortened(found->second, 40) + "\"; allowed is an integer from " +
                          std::to_string(low) + " to " + std::to_string(high),
                      name);
    return static_cast<std::int64_t>(*number);
}

bool flag_in_query(const HttpRequest& request, const std::string& name) {
    const auto found = request.query.find(name);
    if (found == request.query.end() || found->second == "0") return false;
    if (found->second == "1") return true;
    throw Refusal(Refused::unprocessable, name + " is \"" + shortened(found->second, 40) + "\"; allowed are 0 and 1",
                  name);
}

std::vector<Route> service_routes(Service& service, Access& access, Metrics& metrics) {
    return {
        {"GET", "/healthz", Scope::open, 0, [](HttpRequest&) { return json_reply(200, R"({"status":"alive"})"); }},
        {"GET", "/readyz", Scope::open, 0,
         [&service, &access](HttpRequest& request) { return ready(service, access, request); }},
        {"GET", "/version", Scope::open, 0, [](HttpRequest&) { return version(); }},
        {"GET", "/openapi.json", Scope::open, 0,
         [document = openapi()](HttpRequest& request) { return cached_json(request, document); }},
        {"GET", "/metrics", Scope::read, 0,
         [&service, &metrics](HttpRequest&) {
             HttpReply reply;
             reply.type = "text/plain; version=0.0.4; charset=utf-8";
             reply.body = metrics.text(service.counts());
             return reply;
         }},
        {"POST", "/v1/session", Scope::open, 0,
         [&access](HttpRequest& request) { return session(access.open_session(request)); }},
        {"DELETE", "/v1/session", Scope::open, 0,
         [&access](HttpRequest& request) { return session(access.close_session(request)); }},
    };
}

std::vector<Route> all_routes(Service& service, JsonBodies& bodies, Access& access, Metrics& metrics) {
    std::vector<Route> routes = service_routes(service, access, metrics);
    for (std::vector<Route> group : {input_routes(service, bodies), bake_routes(service, bodies),
                                     upload_routes(service), page_routes(service.settings().web.value_or(""))})
        routes.insert(routes.end(), std::make_move_iterator(group.begin()), std::make_move_iterator(group.end()));
    return routes;
}

}  // namespace hairbake
