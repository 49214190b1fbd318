#include <nlohmann/json.hpp>

#include "server/http/json_bodies.h"
#include "server/http/problem.h"
#include "server/http/replies.h"
#include "server/http/routes.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uint64_t json_limit = 64 << 10;

struct ReceivedBlob {
    std::string digest;
    std::uint64_t bytes = 0;
    bool fresh = false;
};

/// Streams the body into the store.
ReceivedBlob receive_blob(Service& service, const HttpRequest& request, const std::string& expected) {
    const std::unique_ptr<IncomingFile> file = service.receive(request.content_length, expected);
    request.read_body([&](std::span<const std::byte> bytes) { file->add(bytes); });
    const bool fresh = service.store_blob(*file, expected);
    return {file->digest(), file->bytes(), fresh};
}

/// The digest in the address, with or without "sha256:".
std::string digest_in(const HttpRequest& request) { return without_prefix(request.parameters.at("sha256")); }

/// The same for the address of a blob.
/// Throws Refusal(unprocessable).
std::string blob_digest_in(const HttpRequest& request) {
    const std::string digest = digest_in(request);
    if (!is_digest(digest))
        throw Refusal(Refused::unprocessable, "a digest is 64 lower-case hexadecimal digits of SHA-256", "sha256");
    return digest;
}

HttpReply put_blob(Service& service, HttpRequest& request) {
    const std::string digest = blob_digest_in(request);
    const ReceivedBlob received = receive_blob(service, request, digest);
    return json_reply(received.fresh ? 201 : 200, Json{{"sha256", digest}, {"bytes", received.bytes}}.dump())
        .with("Location", "/v1/blobs/" + digest);
}

HttpReply get_blob(Service& service, HttpRequest& request) {
    const std::string digest = blob_digest_in(request);
    return file_reply(request, service.open_blob(digest), digest, "application/octet-stream");
}

HttpReply deleted() {
    HttpReply reply;
    reply.status = 204;
    return reply;
}

HttpReply delete_blob(Service& service, HttpRequest& request) {
    const std::string digest = blob_digest_in(request);
    service.remove_blob(digest, flag_in_query(request, "force"));
    return deleted();
}

/// The digest that the JSON body names.
std::string digest_in(JsonBodies& bodies, const HttpRequest& request) {
    return without_prefix(Json::parse(bodies.read(request, "InputRequest").text)["sha256"].get<std::string>());
}

/// A JSON body names the digest of a stored blob; any other body is the file itself.
HttpReply add_input(Service& service, JsonBodies& bodies, HttpRequest& request, const std::string& kind) {
    const std::string type = request.header("Content-Type").value_or("");
    std::string digest;
    if (type.starts_with("application/json")) {
        const std::string allowed = "; allowed is a Content-Length of up to " + std::to_string(json_limit) + " bytes";
        if (!request.content_length) throw Refusal(Refused::too_large, "the JSON body comes in chunks" + allowed);
        if (*request.content_length > json_limit)
            throw Refusal(Refused::too_large,
                          "the JSON body is " + std::to_string(*request.content_length) + " bytes long" + allowed);
        digest = digest_in(bodies, request);
    } else if (type.starts_with("application/octet-stream")) {
        digest = receive_blob(service, request, "").digest;
    } else {
        return problem(
            415, "unsupported",
            "Content-Type is missing; allowed is application/json with a digest, or application/octet-stream",
            "Content-Type");
    }
    const Catalog::Added added = service.add_input(kind, digest);
    return json_reply(added.known ? 200 : 201, added.answer).with("Location", "/v1/" + kind + "s/" + digest);
}

HttpReply get_thumbnail(Service& service, HttpRequest& request, const std::string& kind) {
    const std::string digest = service.catalog().thumbnail(kind, digest_in(request));
    return file_reply(request, service.open_blob(digest), digest, "image/png");
}

HttpReply put_name(Service& service, JsonBodies& bodies, HttpRequest& request) {
    const Json body = Json::parse(bodies.read(request, "NameRequest").text);
    return json_reply(200, service.names().put(request.parameters.at("kind"), request.parameters.at("path"),
                                               without_prefix(body["sha256"].get<std::string>()),
                                               body.value("note", ""), request.caller));
}

HttpReply get_name(Service& service, HttpRequest& request) {
    return cached_json(request, service.names().get(request.parameters.at("kind"), request.parameters.at("path")));
}

/// The cursor of a list that is sorted by texts; empty for the first page.
std::string text_cursor(const HttpRequest& request) {
    const auto cursor = request.query.find("cursor");
    return cursor == request.query.end() ? "" : cursor->second;
}

HttpReply list_names(Service& service, HttpRequest& request) {
    const auto limit = static_cast<int>(number_in_query(request, "limit", 1, 1000, 100));
    return cached_json(request, service.names().list(request.parameters.at("kind"), text_cursor(request), limit));
}

HttpReply list_blobs(Service& service, HttpRequest& request) {
    const auto limit = static_cast<int>(number_in_query(request, "limit", 1, 1000, 100));
    return cached_json(request, service.list_blobs(text_cursor(request), limit, flag_in_query(request, "unneeded")));
}

HttpReply list_inputs(Service& service, HttpRequest& request, const std::string& kind) {
    const auto limit = static_cast<int>(number_in_query(request, "limit", 1, 200, 50));
    const std::int64_t cursor = number_in_query(request, "cursor", 0, INT64_MAX, INT64_MAX);
    return cached_json(request, service.catalog().list(kind, cursor, limit));
}

HttpReply get_input(Service& service, HttpRequest& request, const std::string& kind) {
    return cached_json(request, service.catalog().get(kind, digest_in(request)));
}

HttpReply delete_input(Service& service, HttpRequest& request, const std::string& kind) {
    service.remove_input(kind, digest_in(request), flag_in_query(request, "force"));
    return deleted();
}

/// The routes of models or of environments.
std::vector<Route> catalog_routes(Service& service, JsonBodies& bodies, const std::string& kind) {
    const auto bound = [&service, kind](HttpReply (*handle)(Service&, HttpRequest&, const std::string&)) {
        return [&service, kind, handle](HttpRequest& request) { return handle(service, request, kind); };
    };
    const std::string base = "/v1/" + kind + "s", one = base + "/{sha256}";
    return {
        {"POST",
         base,
         Scope::upload,
         service.settings().blob_bytes,
         [&service, &bodies, kind](HttpRequest& request) { return add_input(service, bodies, request, kind); },
         {"application/json", "application/octet-stream"},
         true},
        {"GET", base, Scope::read, 0, bound(list_inputs)},
        {"GET", one, Scope::read, 0, bound(get_input)},
        {"GET", one + "/thumbnail.png", Scope::read, 0, bound(get_thumbnail)},
        {"DELETE", one, Scope::upload, 0, bound(delete_input)},
    };
}

}  // namespace

std::vector<Route> input_routes(Service& service, JsonBodies& bodies) {
    const auto bound = [&service](HttpReply (*handle)(Service&, HttpRequest&)) {
        return [&service, handle](HttpRequest& request) { return handle(service, request); };
    };
    std::vector<Route> routes{
        {"GET", "/v1/blobs", Scope::read, 0, bound(list_blobs)},
        {"PUT", "/v1/blobs/{sha256}", Scope::upload, service.settings().blob_bytes, bound(put_blob), {}, true},
        {"GET", "/v1/blobs/{sha256}", Scope::read, 0, bound(get_blob)},
        {"DELETE", "/v1/blobs/{sha256}", Scope::upload, 0, bound(delete_blob)},
        {"PUT",
         "/v1/names/{kind}/{path...}",
         Scope::upload,
         json_limit,
         [&](HttpRequest& request) { return put_name(service, bodies, request); },
         {"application/json"}},
        {"GET", "/v1/names/{kind}", Scope::read, 0, bound(list_names)},
        {"GET", "/v1/names/{kind}/{path...}", Scope::read, 0, bound(get_name)},
    };
    for (const char* kind : {"model", "environment"}) {
        const std::vector<Route> of_kind = catalog_routes(service, bodies, kind);
        routes.insert(routes.end(), of_kind.begin(), of_kind.end());
    }
    return routes;
}

}  // namespace hairbake
