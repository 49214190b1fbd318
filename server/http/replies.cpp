#include "server/http/replies.h"

#include <algorithm>
#include <optional>

#include "core/base/digest.h"
#include "server/http/problem.h"
#include "server/http/target.h"

namespace hairbake {
namespace {

struct Span {
    std::uint64_t begin = 0, end = 0;  ///< end is one past the last byte
};

enum class RangeAnswer { whole, part, unsatisfiable };

/// RFC 9110, section 14: one range of bytes. What is not understood is ignored, as it says.
RangeAnswer read_range(const std::string& text, std::uint64_t bytes, Span& span) {
    if (!text.starts_with("bytes=") || text.find(',') != std::string::npos) return RangeAnswer::whole;
    const std::size_t dash = text.find('-');
    if (dash == std::string::npos) return RangeAnswer::whole;
    const std::string first = text.substr(6, dash - 6), last = text.substr(dash + 1);
    const auto from = read_length(first), to = read_length(last);
    if (first.empty()) {  // the last n bytes
        if (!to) return RangeAnswer::whole;
        if (*to == 0 || bytes == 0) return RangeAnswer::unsatisfiable;
        span = {bytes - std::min(bytes, *to), bytes};
        return RangeAnswer::part;
    }
    if (!from || (!last.empty() && (!to || *to < *from))) return RangeAnswer::whole;
    if (*from >= bytes) return RangeAnswer::unsatisfiable;
    span = {*from, last.empty() ? bytes : std::min(bytes, *to == UINT64_MAX ? bytes : *to + 1)};
    return RangeAnswer::part;
}

std::string quoted(const std::string& text) { return std::string(1, '"').append(text).append(1, '"'); }

/// Whether the list of tags in If-None-Match names `tag` (weakly compared).
bool names_tag(const std::string& list, const std::string& tag) {
    return list == "*" || list.find(tag) != std::string::npos;
}

HttpReply not_modified(const std::string& tag) {
    HttpReply reply;
    reply.status = 304;
    return reply.with("ETag", tag);
}

/// Status and headers of a reply with `bytes` bytes, and which of them it has.
HttpReply ranged(const HttpRequest& request, std::uint64_t bytes, const std::string& digest, const std::string& type,
                 Span& span) {
    const std::string tag = quoted(digest);
    span = {0, bytes};
    if (const auto list = request.header("If-None-Match"); list && names_tag(*list, tag)) {
        span = {};
        return not_modified(tag);
    }
    HttpReply reply;
    reply.type = type;
    const auto range = request.header("Range");
    const bool fresh = request.header("If-Range").value_or(tag) == tag;
    const RangeAnswer answer = range && fresh ? read_range(*range, bytes, span) : RangeAnswer::whole;
    if (answer == RangeAnswer::unsatisfiable) {
        span = {};
        return problem(416, "range", "the range lies outside of the " + std::to_string(bytes) + " bytes")
            .with("Content-Range", "bytes */" + std::to_string(bytes));
    }
    if (answer == RangeAnswer::part) {
        reply.status = 206;
        reply.with("Content-Range", "bytes " + std::to_string(span.begin) + "-" + std::to_string(span.end - 1) + "/" +
                                        std::to_string(bytes));
    }
    return reply.with("ETag", tag).with("Accept-Ranges", "bytes");
}

}  // namespace

std::string read_text(const HttpRequest& request) {
    std::string text;
    request.read_body([&](std::span<const std::byte> bytes) {
        text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    });
    return text;
}

HttpReply json_reply(int status, std::string json) {
    HttpReply reply;
    reply.status = status;
    reply.body = std::move(json);
    return reply;
}

HttpReply cached_json(const HttpRequest& request, std::string json) {
    const std::string digest = Digest().add(json).hex();
    return cached_json(request, std::move(json), digest);
}

HttpReply cached_json(const HttpRequest& request, std::string json, const std::string& digest) {
    const std::string tag = quoted(digest.substr(0, 32));
    if (const auto list = request.header("If-None-Match"); list && names_tag(*list, tag)) return not_modified(tag);
    return json_reply(200, std::move(json)).with("ETag", tag).with("Cache-Control", "no-cache");
}

HttpReply file_reply(const HttpRequest& request, OpenBlob blob, const std::string& digest, const std::string& type) {
    Span span;
    HttpReply reply = ranged(request, blob.bytes, digest, type, span);
    if (span.begin == span.end) return reply;
    const auto owner = std::make_shared<Descriptor>(std::move(blob.file));
    reply.file = FileBody{blob_name(digest), owner, owner->get(), span.begin, span.end - span.begin};
    return reply;
}

HttpReply text_reply(const HttpRequest& request, const std::string& text, const std::string& digest,
                     const std::string& type) {
    Span span;
    HttpReply reply = ranged(request, text.size(), digest, type, span);
    if (span.begin != span.end) reply.body = text.substr(span.begin, span.end - span.begin);
    return reply;
}

std::string media_type(const std::string& name) {
    if (name.ends_with(".json")) return "application/json";
    if (name.ends_with(".png")) return "image/png";
    if (name.ends_with(".exr")) return "image/x-exr";
    if (name.ends_with(".ktx2")) return "image/ktx2";
    if (name.ends_with(".dds")) return "image/vnd-ms.dds";
    if (name.ends_with(".glb")) return "model/gltf-binary";
    return "application/octet-stream";
}

}  // namespace hairbake
