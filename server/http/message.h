// Requests and replies of the routes, independent of the HTTP library.
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
    std::map<std::string, std::string> query;     ///< decoded; of equal names, the last value
    std::optional<std::uint64_t> content_length;  ///< nothing: chunked, or no body
    bool has_body = false;
    /// The first header of that name, in upper or lower case. Values may be percent-decoded and have no control
    /// characters.
    std::function<std::optional<std::string>(const std::string&)> header;
    /// Feeds the body to the receiver in pieces. Exceptions of the receiver pass through.
    /// Throws Refusal(malformed) when the body ends early.
    std::function<void(const std::function<void(std::span<const std::byte>)>&)> read_body;
    std::map<std::string, std::string> parameters;  ///< values of the route's {…}
    std::string caller;                             ///< the token's name, or "local"
};

/// `length` bytes of an open file from `offset`.
struct FileBody {
    std::string name;             ///< in the store's folder blobs
    std::shared_ptr<void> owner;  ///< keeps the descriptor open
    int descriptor = -1;
    std::uint64_t offset = 0, length = 0;
};

/// Whether a proxy forwards the request. nginx, as configured in docker/, sets X-Forwarded-For on all requests.
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
