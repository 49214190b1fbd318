// Requests and replies as the routes see them: no type of the HTTP library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace hairbake {

struct HttpRequest {
    std::string method;
    std::vector<std::string> path;                ///< decoded segments; none is empty, "." or ".."
    std::map<std::string, std::string> query;     ///< decoded; the last of equal names
    std::optional<std::uint64_t> content_length;  ///< none: chunked, or no body
    bool has_body = false;
    /// First header of the name, in any case; values may have been percent-decoded, control characters are refused
    /// before.
    std::function<std::optional<std::string>(const std::string&)> header;
    /// Feeds the body in pieces. Throws Refusal(malformed) when it ends early; what the receiver throws passes through.
    std::function<void(const std::function<void(std::span<const std::byte>)>&)> read_body;
    std::map<std::string, std::string> parameters;  ///< what the route's {…} stand for
    std::string caller;                             ///< the token's name, or "local"
};

/// `length` bytes of an open file from `offset`.
struct FileBody {
    std::string name;             ///< in the store's folder blobs
    std::shared_ptr<void> owner;  ///< keeps the descriptor open
    int descriptor = -1;
    std::uint64_t offset = 0, length = 0;
};

/// Whether a proxy stands between the client and the daemon: ours sets X-Forwarded-For on everything that it forwards.
inline bool is_forwarded(const HttpRequest& request) {
    return request.header("X-Forwarded-For") || request.header("Forwarded");
}

struct HttpReply {
    int status = 200;
    std::vector<std::pair<std::string, std::string>> headers;
    std::string type = "application/json";
    std::string body;
    std::optional<FileBody> file;

    HttpReply& with(std::string name, std::string value) & {
        headers.emplace_back(std::move(name), std::move(value));
        return *this;
    }
    HttpReply with(std::string name, std::string value) && {
        headers.emplace_back(std::move(name), std::move(value));
        return std::move(*this);
    }
};

}  // namespace hairbake
