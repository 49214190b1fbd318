// HTTP by libcurl: one call, one answer. The only code that uses libcurl.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "clients/cli/exit_code.h"
#include "core/base/progress.h"

namespace hairbake {

struct HttpAnswer {
    int status = 0;
    std::map<std::string, std::string> headers;  ///< names in lower case; the last of equal names
    std::string body;

    /// The value of a header; empty when there is none.
    std::string header(const std::string& name) const;
};

struct HttpCall {
    std::string method = "GET";
    std::string path;                    ///< from the root, with the query
    std::vector<std::string> headers{};  ///< "Name: value"
    std::string body{};
    /// Gives the body in pieces, in place of `body`: fills the span and returns the number of bytes.
    /// `source_bytes` in all.
    std::function<std::size_t(std::span<std::byte>)> source{};
    std::uint64_t source_bytes = 0;
    /// Takes the body of a 2xx answer in pieces, in place of HttpAnswer::body. An exception of it ends the call.
    std::function<void(const HttpAnswer& head, std::span<const std::byte>)> sink{};
    std::uint64_t most_bytes = 16 << 20;  ///< a body that is longer is cut off and refused
};

/// The connection could not be made or was lost. A retry of the call may succeed.
class ConnectionLost : public RemoteError {
public:
    explicit ConnectionLost(const std::string& message) : RemoteError(ExitCode::unreachable, message) {}
};

/// Not thread-safe. Follows no redirect, and talks http and https only.
class HttpClient {
public:
    /// url:     without a slash at its end
    /// token:   may be empty
    /// ca_file: certificates (PEM) that replace the system's; empty: the system's
    HttpClient(std::string url, const std::string& token, const std::string& ca_file);
    ~HttpClient();
    HttpClient(const HttpClient&) = delete;
    HttpClient& operator=(const HttpClient&) = delete;

    /// Makes one call. An error status is an answer too.
    /// Throws ConnectionLost.
    /// Throws RemoteError(unreachable) for a failure that a retry does not mend (an untrusted certificate).
    /// Throws RemoteError(refused) for an answer that is too long.
    /// Throws Error(cancelled) within 0.1 s of a cancel.
    HttpAnswer send(const HttpCall& call, const Progress& progress);

private:
    struct Handles;
    std::string url_;
    std::unique_ptr<Handles> handles_;
};

}  // namespace hairbake
