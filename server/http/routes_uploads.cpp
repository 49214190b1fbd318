#include <ctime>

#include "server/http/problem.h"
#include "server/http/replies.h"
#include "server/http/routes.h"
#include "server/http/target.h"

namespace hairbake {
namespace {

/// "Wed, 21 Oct 2026 07:28:00 GMT".
std::string http_date(double seconds) {
    const auto time = static_cast<std::time_t>(seconds);
    std::tm parts{};
    ::gmtime_r(&time, &parts);
    char text[40];
    std::strftime(text, sizeof text, "%a, %d %b %Y %H:%M:%S GMT", &parts);
    return text;
}

/// Decodes the base64 of tus. Empty when it is malformed.
std::string base64_decoded(const std::string& text) {
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string decoded;
    unsigned buffer = 0;
    int held = 0;
    for (const char c : text) {
        if (c == '=') break;
        const std::size_t value = letters.find(c);
        if (value == std::string::npos) return {};
        buffer = (buffer << 6 | static_cast<unsigned>(value)) & 0xffff;
        if ((held += 6) >= 8) decoded += static_cast<char>(buffer >> (held -= 8) & 0xff);
    }
    return decoded;
}

/// The value of `key` in "key base64,key2 base64".
std::string metadata_value(const std::string& metadata, const std::string& key) {
    for (std::size_t begin = 0; begin < metadata.size();) {
        const std::size_t end = std::min(metadata.find(',', begin), metadata.size());
        std::string pair = metadata.substr(begin, end - begin);
        pair.erase(0, std::min(pair.find_first_not_of(' '), pair.size()));
        if (pair.starts_with(key + " ")) return base64_decoded(pair.substr(key.size() + 1));
        begin = end + 1;
    }
    return {};
}

HttpReply tus_reply(int status) {
    HttpReply reply;
    reply.status = status;
    return reply.with("Tus-Resumable", "1.0.0").with("Cache-Control", "no-store");
}

std::uint64_t length_header(const HttpRequest& request, const std::string& name) {
    const auto length = read_length(request.header(name).value_or(""));
    if (!length) throw Refusal(Refused::malformed, name + " is missing or not a number", name);
    return *length;
}

HttpReply options(Service& service) {
    HttpReply reply;
    reply.status = 204;
    return reply.with("Tus-Resumable", "1.0.0")
        .with("Tus-Version", "1.0.0")
        .with("Tus-Extension", "creation,termination,expiration")
        .with("Tus-Max-Size", std::to_string(service.settings().blob_bytes))
        .with("Allow", "OPTIONS, POST");
}

HttpReply create(Service& service, HttpRequest& request) {
    const std::uint64_t bytes = length_header(request, "Upload-Length");
    const std::string metadata = request.header("Upload-Metadata").value_or("");
    const std::string digest = without_prefix(metadata_value(metadata, "sha256"));
    const UploadState state = service.uploads().create(bytes, digest, metadata, request.caller);
    return tus_reply(201)
        .with("Location", "/v1/uploads/" + state.id)
        .with("Upload-Offset", "0")
        .with("Upload-Expires", http_date(state.expires));
}

HttpReply look(Service& service, HttpRequest& request) {
    const UploadState state = service.uploads().get(request.parameters.at("id"));
    HttpReply reply = tus_reply(200)
                          .with("Upload-Offset", std::to_string(state.offset))
                          .with("Upload-Length", std::to_string(state.bytes))
                          .with("Upload-Expires", http_date(state.expires));
    if (!state.metadata.empty()) reply.with("Upload-Metadata", state.metadata);
    return reply;
}

HttpReply append(Service& service, HttpRequest& request) {
    if (!request.header("Content-Type"))
        return problem(415, "unsupported", "Content-Type is missing; allowed is application/offset+octet-stream",
                       "Content-Type");
    const std::uint64_t offset = length_header(request, "Upload-Offset");
    const Uploads::Appended appended =
        service.uploads().append(request.parameters.at("id"), offset, request.content_length, request.read_body);
    HttpReply reply = tus_reply(204).with("Upload-Offset", std::to_string(appended.offset));
    if (appended.blob.empty())
        reply.with("Upload-Expires", http_date(appended.expires));
    else
        reply.with("Hairbake-Blob", "/v1/blobs/" + appended.blob);
    return reply;
}

/// Wraps a handler: all requests but OPTIONS must name the version of tus.
std::function<HttpReply(HttpRequest&)> tus(Service& service, HttpReply (*handle)(Service&, HttpRequest&)) {
    return [&service, handle](HttpRequest& request) {
        if (request.header("Tus-Resumable").value_or("") == "1.0.0") return handle(service, request);
        return problem(412, "tus-version", "Tus-Resumable is not 1.0.0", "Tus-Resumable").with("Tus-Version", "1.0.0");
    };
}

}  // namespace

std::vector<Route> upload_routes(Service& service) {
    const std::string base = "/v1/uploads", one = base + "/{id}";
    return {
        {"OPTIONS", base, Scope::open, 0, [&service](HttpRequest&) { return options(service); }},
        {"POST", base, Scope::upload, 0, tus(service, create)},
        {"HEAD", one, Scope::upload, 0, tus(service, look)},
        {"PATCH",
         one,
         Scope::upload,
         service.settings().blob_bytes,
         tus(service, append),
         {"application/offset+octet-stream"},
         true},
        {"DELETE", one, Scope::upload, 0,
         tus(service,
             [](Service& s, HttpRequest& request) {
                 s.remove_upload(request.parameters.at("id"));
                 return tus_reply(204);
             })},
    };
}

}  // namespace hairbake
