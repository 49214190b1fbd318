#include "core/base/short_text.h"
#include "server/http/json_bodies.h"
#include "server/http/replies.h"
#include "server/http/routes.h"

namespace hairbake {
namespace {

constexpr std::uint64_t request_limit = 1 << 20, rebake_limit = 4 << 20;

/// Digests may be written with or without "sha256:".
std::string text_in_query(const HttpRequest& request, const std::string& name) {
    const auto found = request.query.find(name);
    if (found == request.query.end()) return {};
    return without_prefix(found->second);
}

HttpReply post_bake(Service& service, JsonBodies& bodies, HttpRequest& request) {
    const JsonBody body = bodies.read(request, "BakeRequest");
    const Service::Answer answer = service.submit(body.text);
    HttpReply reply = json_reply(answer.state == JobState::done ? 200 : 202, answer.json);
    reply.with("Location", "/v1/bakes/" + answer.id);
    return with_warnings(std::move(reply), answer.warnings);
}

HttpReply list_bakes(Service& service, HttpRequest& request) {
    BakeFilter filter;
    const std::string state = text_in_query(request, "state");
    filter.state = job_state(state);
    if (!state.empty() && !filter.state)
        throw Refusal(Refused::unprocessable,
                      "state is " + shortened(state, 40) + "; allowed is " + list_names(job_states), "state");
    filter.model = text_in_query(request, "model");
    filter.environment = text_in_query(request, "environment");
    filter.name = text_in_query(request, "name");
    filter.batch = text_in_query(request, "batch");
    filter.limit = static_cast<int>(number_in_query(request, "limit", 1, 1000, 50));
    filter.cursor = number_in_query(request, "cursor", 0, INT64_MAX, INT64_MAX);
    return cached_json(request, service.bakes().list(filter));
}

HttpReply get_file(Service& service, HttpRequest& request) {
    const BakeFile file = service.bakes().file(request.parameters.at("id"), request.parameters.at("name"));
    const std::string type = media_type(file.name);
    if (!file.blob) return text_reply(request, file.text, file.etag, type);
    return file_reply(request, service.open_blob(*file.blob), *file.blob, type);
}

HttpReply post_rebake(Service& service, JsonBodies& bodies, HttpRequest& request) {
    const bool dry_run = flag_in_query(request, "dry_run");
    const JsonBody body = bodies.read(request, "RebakeRequest");
    const Batches::Rebaked rebaked = service.batches().rebake(body.text, dry_run);
    HttpReply reply = json_reply(dry_run ? 200 : 202, rebaked.json);
    if (!dry_run) reply.with("Location", "/v1/batches/" + rebaked.batch);
    return with_warnings(std::move(reply), rebaked.warnings);
}

}  // namespace

std::vector<Route> bake_routes(Service& service, JsonBodies& bodies) {
    const auto bound = [&service](HttpReply (*handle)(Service&, HttpRequest&)) {
        return [&service, handle](HttpRequest& request) { return handle(service, request); };
    };
    const auto with_body = [&](HttpReply (*handle)(Service&, JsonBodies&, HttpRequest&)) {
        return [&service, &bodies, handle](HttpRequest& request) { return handle(service, bodies, request); };
    };
    return {
        {"POST", "/v1/bakes", Scope::bake, request_limit, with_body(post_bake), {"application/json"}},
        {"GET", "/v1/bakes", Scope::read, 0, bound(list_bakes)},
        {"GET", "/v1/bakes/{id}", Scope::read, 0,
         [&service](HttpRequest& r) {
             BakeView view = service.bakes().get(r.parameters.at("id"));
             return cached_json(r, std::move(view.json), view.digest);
         }},
        {"DELETE", "/v1/bakes/{id}", Scope::bake, 0,
         [&service](HttpRequest& r) {
             service.cancel(r.parameters.at("id"));
             return json_reply(200, service.bakes().get(r.parameters.at("id")).json);
         }},
        {"GET", "/v1/bakes/{id}/files/{name}", Scope::read, 0, bound(get_file)},
        {"POST", "/v1/rebakes", Scope::bake, rebake_limit, with_body(post_rebake), {"application/json"}},
        {"GET", "/v1/batches/{id}", Scope::read, 0,
         [&service](HttpRequest& r) { return cached_json(r, service.batches().get(r.parameters.at("id"))); }},
    };
}

}  // namespace hairbake
