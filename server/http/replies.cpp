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

struct ReadRange {
    RangeAnswer answer = RangeAnswer::whole;
    Span span;  ///< of a part
};

/// One range of bytes of RFC 9110, section 14. A header that is not understood asks for the whole, as the RFC demands.
ReadRange read_range(const std::string& text, std::uint64_t bytes) {
    if (!text.starts_with("bytes=") || text.find(',') != std::string::npos) return {};
    const std::size_t dash = text.find('-');
    if (dash == std::string::npos) return {};
    const std::string first = text.substr(6, dash - 6), last = text.substr(dash + 1);
    const auto from = read_length(first), to = read_length(last);
    if (first.empty()) {  // the last n bytes
        if (!to) return {};
        if (*to == 0 || bytes == 0) return {RangeAnswer::unsatisfiable, {}};
        return {RangeAnswer::part, {bytes - std::min(bytes, *to), bytes}};
    }
    if (!from || (!last.empty() && (!to || *to < *from))) return {};
    if (*from >= bytes) return {RangeAnswer::unsatisfiable, {}};
    return {RangeAnswer::part, {*from, last.empty() ? bytes : std::min(bytes, *to == UINT64_MAX ? bytes : *to + 1)}};
}

std::string in_quotes(const std::string& text) { return std::string(1, '"').append(text).append(1, '"'); }

/// Whether the list of tags in If-None-Match names `tag` (weakly compared).
bool names_tag(const std::string& list, const std::string& tag) {
    return list == "*" || list.find(tag) != std::string::npos;
}

HttpReply not_modified(const std::string& tag) {
    HttpReply reply;
    reply.status = 304;
    return reply.with("ETag", tag);
}

/// A reply without its body, and the bytes that belong into it.
struct Ranged {
    HttpReply reply;
    Span span;
};

Ranged ranged(const HttpRequest& request, std::uint64_t bytes, const std::string& digest, const std::string& type) {
    const std::string tag = in_quotes(digest);
    if (const auto list = request.header("If-None-Match"); list && names_tag(*list, tag))
        return {not_modified(tag), {}};
    const auto range = request.header("Range");
    const bool is_fresh = request.header("If-Range").value_or(tag) == tag;
    const ReadRange asked = range && is_fresh ? read_range(*range, bytes) : ReadRange();
    if (asked.answer == RangeAnswer::unsatisfiable)
        return {problem(416, "range", "the range lies outside of the " + std::to_string(bytes) + " bytes")
                    .with("Content-Range", "bytes */" + std::to_string(bytes)),
                {}};
    Ranged answer{{}, {0, bytes}};
    answer.reply.type = type;
    if (asked.answer == RangeAnswer::part) {
        answer.span = asked.span;
        answer.reply.status = 206;
        answer.reply.with("Content-Range", "bytes " + std::to_string(asked.span.begin) + "-" +
                                               std::to_string(asked.span.end - 1) + "/" + std::to_string(bytes));
    }
    answer.reply.with("ETag", tag).with("Accept-Ranges", "bytes");
    return answer;
}

}  // namespace

HttpReply json_reply(int status, std::string json) {
    HttpReply reply;
    reply.status = status;
    reply.body = std::move(json);
    return reply;
}

HttpReply with_warnings(HttpReply reply, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
        std::string plain;  // a quoted string without the characters that would need a backslash
        for (const char c : text) plain += c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20 ? '\'' : c;
        reply.with("Warning", "299 - " + in_quotes(plain));
    }
    return reply;
}

HttpReply cached_json(const HttpRequest& request, std::string json) {
    const std::string digest = Digest().add(json).hex();
    return cached_json(request, std::move(json), digest);
}

HttpReply cached_json(const HttpRequest& request, std::string json, const std::string& digest) {
    const std::string tag = in_quotes(digest.substr(0, 32));
    if (const auto list = request.header("If-None-Match"); list && names_tag(*list, tag)) return not_modified(tag);
    return json_reply(200, std::move(json)).with("ETag", tag).with("Cache-Control", "no-cache");
}

HttpReply file_reply(const HttpRequest& request, OpenBlob blob, const std::string& digest, const std::string& type) {
    auto [reply, span] = ranged(request, blob.bytes, digest, type);
    if (span.begin == span.end) return reply;
    const auto owner = std::make_shared<Descriptor>(std::move(blob.file));
    reply.file = FileBody{blob_name(digest), owner, owner->get(), span.begin, span.end - span.begin};
    return std::move(reply);
}

HttpReply text_reply(const HttpRequest& request, const std::string& text, const std::string& digest,
                     const std::string& type) {
    auto [reply, span] = ranged(request, text.size(), digest, type);
    if (span.begin != span.end) reply.body = text.substr(span.begin, span.end - span.begin);
    return std::move(reply);
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
