#include "server/http/http_server.h"

#define CPPHTTPLIB_USE_POLL
#define CPPHTTPLIB_LISTEN_BACKLOG 1024
#include <httplib.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <exception>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/error.h"
#include "core/base/short_text.h"
#include "server/http/body_places.h"
#include "server/http/connection.h"
#include "server/http/connection_threads.h"
#include "server/http/lingering.h"
#include "server/http/problem.h"
#include "server/http/request_reader.h"
#include "server/http/target.h"
#include "server/jobs/service.h"

namespace hairbake {
namespace {

using namespace std::chrono_literals;
constexpr Connection::Patience patience{.head = 10s, .read = 30s, .write = 60s};
/// So long a client may keep a thread waiting for its head, or for its short body, while others wait for a thread.
constexpr std::chrono::milliseconds grace = 1s;
constexpr std::chrono::milliseconds lingering = 1s;
constexpr std::size_t most_lingering = 1000;  // connections
/// A body of up to this size is in nginx's first read (proxy_buffer_size), so nginx need not buffer it.
constexpr std::size_t one_read = 6144;
constexpr std::size_t longest_shown = 100;  // of a header or an address in a message
const std::string any_path = "/";           // every request gets this path in the library; the routing is ours

/// Whether the current connection's request was not read to its end.
thread_local bool body_left = false;
/// Of the current connection.
thread_local const RequestReader* current_reader = nullptr;

/// Adapts a connection to the library.
class ConnectionStream : public httplib::Stream {
public:
    ConnectionStream(Connection& connection, RequestReader& reader) : connection_(connection), reader_(reader) {}

    bool is_readable() const override { return connection_.await_readable(); }
    bool is_writable() const override { return connection_.await_writable(); }
    ssize_t read(char* data, std::size_t size) override { return reader_.read(data, size); }
    /// What the library answers to a head that was given up is left out.
    ssize_t write(const char* data, std::size_t size) override {
        const bool is_left_out = reader_.in_head() && !reader_.given_up().empty();
        return is_left_out ? static_cast<ssize_t>(size) : connection_.write(data, size);
    }
    void get_remote_ip_and_port(std::string&, int&) const override {}  // not used
    void get_local_ip_and_port(std::string&, int&) const override {}
    socket_t socket() const override { return connection_.socket(); }

private:
    Connection& connection_;
    RequestReader& reader_;
};

/// Calls `answer`; drops the connection when it throws, so that no exception ends a thread.
void or_drop(const std::function<void()>& answer) {
    try {
        answer();
    } catch (const std::exception& error) {  // out of memory where the library does not catch it
        spdlog::error("a connection was dropped: {}", error.what());
    }
}

/// Buffers a reply whose head the library does not make.
void write_reply(Connection& connection, const std::string& status, const HttpReply& reply) {
    std::string text = "HTTP/1.1 " + status + "\r\nContent-Type: " + reply.type +
                       "\r\nContent-Length: " + std::to_string(reply.body.size());
    for (const auto& [name, value] : reply.headers) text += "\r\n" + name + ": " + value;
    text += "\r\nConnection: close\r\n\r\n" + reply.body;
    connection.write(text.data(), text.size());
}

/// Never waits for the client: one thread refuses all connections.
void refuse_connection(int accepted, const HttpServerSettings& settings, Lingering& lingering) {
    Connection connection(accepted, {.head = 0s, .read = 0s, .write = 0s});
    HttpReply busy = problem(503, "busy",
                             std::to_string(settings.threads) + " requests are being answered and " +
                                 std::to_string(settings.waiting) +
                                 " wait; allowed are no more ([listen] threads, waiting): try again in 2 s");
    write_reply(connection, "503 Service Unavailable", busy.with("Retry-After", "2"));
    connection.flush();
    lingering.add(connection.release());
}

/// Whether the client waits for "100 Continue" (RFC 9110, section 10.1.1).
bool awaits_continue(const httplib::Request& request) {
    std::string expected = request.get_header_value("Expect");
    std::transform(expected.begin(), expected.end(), expected.begin(), [](unsigned char c) { return std::tolower(c); });
    return expected == "100-continue" && request.version == "HTTP/1.1";
}

bool is_chunked(const httplib::Request& request) { return request.has_header("Transfer-Encoding"); }

/// Whether nginx did not forward the request. What nginx forwards comes whole, or has a place, or is an upload.
bool is_local(const httplib::Request& request) {
    return !request.has_header("X-Forwarded-For") && !request.has_header("Forwarded");
}

bool is_short(const httplib::Request& request) {
    return !is_chunked(request) && read_length(request.get_header_value("Content-Length")).value_or(0) <= long_body;
}

/// The reply to a request with a malformed head. Nothing when the head is well-formed.
std::optional<HttpReply> wrong_head(const httplib::Request& request, const std::optional<Target>& target) {
    const auto refuse = [](const std::string& words) { return problem(400, "malformed", words); };
    const auto shown = [](const std::string& text) { return quoted(text, longest_shown); };
    for (const auto& [name, value] : request.headers)
        if (has_control_characters(name) || has_control_characters(value))
            return refuse("the header " + shown(name) + " has a control character: " + shown(value) +
                          "; allowed are printable characters and tabs");
    const std::size_t lengths = request.get_header_value_count("Content-Length");
    const std::size_t codings = request.get_header_value_count("Transfer-Encoding");
    if (lengths + codings > 1) return refuse("the body's length is given more than once");
    if (lengths && !read_length(request.get_header_value("Content-Length")))
        return refuse("Content-Length is no number");
    if (codings && request.get_header_value("Transfer-Encoding") != "chunked")
        return problem(501, "malformed", "the only Transfer-Encoding is chunked");
    const bool body = codings || (lengths && *read_length(request.get_header_value("Content-Length")) > 0);
    if (body && request.method != "POST" && request.method != "PUT" && request.method != "PATCH")
        return refuse("a " + request.method + " has no body here");
    if (request.get_header_value_count("Host") != 1 && request.version == "HTTP/1.1")
        return refuse("the request needs exactly one Host header");
    if (request.has_header("Content-Encoding") && request.get_header_value("Content-Encoding") != "identity")
        return problem(415, "unsupported", "compressed bodies are not accepted", "Content-Encoding");
    if (request.get_header_value("Content-Type").starts_with("multipart/"))
        return problem(415, "unsupported", "a body is one file or one JSON object", "Content-Type");
    if (!target)
        return refuse(
            "the address " + shown(request.target) +
            " is not a plain path; allowed is a path that begins with / and has no empty segment, no . or .., no "
            "encoded / and no control characters");
    return std::nullopt;
}

/// Feeds the body to `receiver`. An exception of the receiver is carried past the library.
void read_body(const httplib::ContentReader& reader, const std::function<void(std::span<const std::byte>)>& receiver) {
    std::exception_ptr failure;
    const bool whole = reader([&](const char* data, std::size_t size) {
        try {
            receiver({reinterpret_cast<const std::byte*>(data), size});
            return true;
        } catch (...) {
            failure = std::current_exception();
            return false;
        }
    });
    if (failure) std::rethrow_exception(failure);
    if (const std::string& slow = current_reader->given_up(); !slow.empty()) throw Refusal(Refused::too_slow, slow);
    if (!whole) throw Refusal(Refused::malformed, "the body ended early or its chunks are malformed");
    body_left = false;
}

HttpRequest to_request(const httplib::Request& from, Target target, const httplib::ContentReader* reader) {
    HttpRequest request;
    request.method = from.method;
    request.path = std::move(target.path);
    request.query = std::move(target.query);
    if (from.has_header("Content-Length"))
        request.content_length = read_length(from.get_header_value("Content-Length"));
    request.has_body = is_chunked(from) || request.content_length.value_or(0) > 0;
    request.header = [&from](const std::string& name) -> std::optional<std::string> {
        if (!from.has_header(name)) return std::nullopt;
        return from.get_header_value(name);
    };
    request.read_body = [reader](const std::function<void(std::span<const std::byte>)>& receiver) {
        if (reader) read_body(*reader, receiver);
    };
    return request;
}

void send_file(httplib::Response& to, const FileBody& file, const std::string& type) {
    to.set_content_provider(static_cast<std::size_t>(file.length), type,
                            [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                static thread_local std::vector<char> piece(1 << 18);
                                const ssize_t count =
                                    ::pread(file.descriptor, piece.data(), std::min(length, piece.size()),
                                            static_cast<off_t>(file.offset + offset));
                                return count > 0 && sink.write(piece.data(), static_cast<std::size_t>(count));
                            });
}

/// Names the file in X-Accel-Redirect instead of sending it: nginx sends it, or the requested range, with the reply's
/// headers.
void leave_to_nginx(HttpReply& reply, const std::string& accel) {
    reply.status = 200;
    std::erase_if(reply.headers, [](const auto& header) {
        return header.first == "Content-Range" || header.first == "Accept-Ranges";
    });
    reply.with("X-Accel-Redirect", accel + reply.file->name).with("Content-Type", reply.type);
    reply.file.reset();
}

/// Whether nginx compresses the reply (gzip_min_length). It needs its buffer then.
bool is_compressed(const HttpRequest& request, const HttpReply& reply) {
    return reply.body.size() >= 1000 &&
           request.header("Accept-Encoding").value_or("").find("gzip") != std::string::npos;
}

void fill(httplib::Response& to, HttpReply reply) {
    to.status = reply.status;
    for (const auto& [name, value] : reply.headers) to.set_header(name, value);
    to.set_header("X-Content-Type-Options", "nosniff");
    if (reply.file && reply.file->length > 0)
        send_file(to, *reply.file, reply.type);
    else if (!reply.body.empty())
        to.set_content(std::move(reply.body), reply.type);
}

/// Removes the socket of a killed daemon.
/// Throws Error(usage) when a process listens on the socket, and when the file is no socket.
void remove_dead_socket(const std::string& path) {
    struct stat facts {};
    if (::lstat(path.c_str(), &facts) != 0) return;
    if (!S_ISSOCK(facts.st_mode)) throw Error(ErrorKind::usage, path + " exists and is no socket");
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const bool lives = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    ::close(probe);
    if (lives) throw Error(ErrorKind::usage, "another process listens on the socket " + path);
    ::unlink(path.c_str());
}

}  // namespace

class HttpServer::Listener : public httplib::Server {
public:
    Listener(const HttpServerSettings& settings, HttpServer::Handler handler)
        : handler_(std::move(handler)),
          accel_(settings.accel),
          pace_(settings.pace),
          address_(bind(settings)),
          listening_(svr_sock_.load()) {
        set_payload_max_length(std::numeric_limits<std::size_t>::max());  // the router limits bodies
        handle_requests();
        handle_failures();
        threads_.emplace(
            listening_.get(), settings.threads, settings.waiting,
            [this](int accepted, const ConnectionThreads& threads) {
                or_drop([&] { serve_connection(accepted, threads); });
            },
            [this, settings](int accepted) { or_drop([&] { refuse_connection(accepted, settings, lingering_); }); });
    }

    const std::string& address() const { return address_; }

    void join() { threads_->join(); }

    void stop() {
        svr_sock_ = INVALID_SOCKET;  // the library reads it to see whether to continue a long body
        threads_->stop();
    }

private:
    /// Requests without a body are answered before the library's routing, the others when their body can be read.
    void handle_requests() {
        set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
            body_left = request.has_header("Content-Length") || is_chunked(request);
            std::optional<Target> target = read_target(request.target);
            if (std::optional<HttpReply> wrong = wrong_head(request, target))
                fill(response, std::move(*wrong));
            else if (request.method == "GET" || request.method == "HEAD" || request.method == "OPTIONS")
                answer(request, std::move(*target), nullptr, response);
            else
                return HandlerResponse::Unhandled;
            return HandlerResponse::Handled;
        });
        const auto with_body = [this](const httplib::Request& request, httplib::Response& response,
                                      const httplib::ContentReader& reader) {
            answer(request, *read_target(request.target), &reader, response);
        };
        Post(any_path, with_body).Put(any_path, with_body).Patch(any_path, with_body).Delete(any_path, with_body);
    }

    /// Exceptions, and errors that the library answers by itself, become problem+json.
    void handle_failures() {
        set_exception_handler(
            [](const httplib::Request&, httplib::Response& response, const std::exception_ptr& failure) {
                try {
                    std::rethrow_exception(failure);
                } catch (...) {
                    fill(response, problem_of_current_exception());
                }
            });
        set_error_handler([](const httplib::Request&, httplib::Response& response) {
            if (response.body.empty()) fill(response, problem_of_status(response.status));
            return HandlerResponse::Unhandled;
        });
        set_post_routing_handler([](const httplib::Request&, httplib::Response& response) {
            if (response.status == 204 || response.status == 304) response.headers.erase("Content-Length");
            if (response.body.empty() || response.has_header("Content-Length")) return;
            response.set_header("Content-Length", std::to_string(response.body.size()));  // the library's own errors
        });
    }

    /// Returns the address.
    std::string bind(const HttpServerSettings& settings) {
        set_tcp_nodelay(true);
        // Not SO_REUSEPORT: two daemons could share a port.
        set_socket_options([](socket_t listening) {
            const int yes = 1;
            ::setsockopt(listening, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
            ::fcntl(listening, F_SETFD, FD_CLOEXEC);
        });
        if (!settings.socket.empty()) {
            remove_dead_socket(settings.socket);
            set_address_family(AF_UNIX);
            if (!bind_to_port(settings.socket, 80))
                throw Error(ErrorKind::usage, "cannot listen on the socket " + settings.socket);
            ::chmod(settings.socket.c_str(), 0660);
            return "unix:" + settings.socket;
        }
        int port = settings.port;
        const bool bound =
            port ? bind_to_port(settings.address, port) : (port = bind_to_any_port(settings.address)) > 0;
        if (!bound)
            throw Error(ErrorKind::usage,
                        "cannot listen on " + settings.address + " port " + std::to_string(port) + "; is it in use?");
        const bool six = settings.address.find(':') != std::string::npos;
        return "http://" + (six ? "[" + settings.address + "]" : settings.address) + ":" + std::to_string(port);
    }

    void answer(const httplib::Request& from, Target target, const httplib::ContentReader* reader,
                httplib::Response& to) {
        HttpRequest request = to_request(from, std::move(target), reader);
        HttpReply reply = handler_(request);
        if (is_forwarded(request)) {
            if (reply.file && !accel_.empty())
                leave_to_nginx(reply, accel_);
            else if (!reply.file && reply.body.size() <= one_read && !is_compressed(request, reply))
                reply.with("X-Accel-Buffering", "no");
        }
        fill(to, std::move(reply));
    }

    void serve_connection(int accepted, const ConnectionThreads& threads) {
        Connection connection(accepted, patience);
        const auto begin = std::chrono::steady_clock::now();
        const auto keeps_thread = [&, this] {
            if (svr_sock_ == INVALID_SOCKET) return false;
            return !threads.others_wait() || std::chrono::steady_clock::now() - begin < grace;
        };
        if (!connection.await_head(keeps_thread)) return;
        body_left = true;  // until the head is parsed
        serve_request(connection, keeps_thread);
        connection.flush();
        if (body_left) lingering_.add(connection.release());
    }

    void serve_request(Connection& connection, const std::function<bool()>& keeps_thread) {
        RequestReader reader(connection, pace_, keeps_thread);
        ConnectionStream stream(connection, reader);
        current_reader = &reader;
        bool closed = false;
        process_request(stream, "", 0, "", 0, true, closed, [&reader](httplib::Request& request) {
            reader.end_head(awaits_continue(request), is_local(request) && is_short(request));
            request.headers.erase("Expect");  // the library would reply before the request is checked
            request.path = any_path;          // the real path is in the target
            request.ranges.clear();           // we parse Range ourselves
        });
        if (reader.in_head() && !reader.given_up().empty())
            write_reply(connection, "408 Request Timeout", problem(408, "too-slow", reader.given_up()));
    }

    HttpServer::Handler handler_;
    const std::string accel_;
    const BodyPace::Limits pace_;
    const std::string address_;
    const Descriptor listening_;
    Lingering lingering_{lingering, most_lingering};
    /// The last member: the threads use the others, and start when those are ready.
    std::optional<ConnectionThreads> threads_;
};

HttpServer::HttpServer(const HttpServerSettings& settings, Handler handler)
    : listener_(std::make_unique<Listener>(settings, std::move(handler))) {}
HttpServer::~HttpServer() = default;

std::string HttpServer::address() const { return listener_->address(); }
void HttpServer::join() { listener_->join(); }
void HttpServer::stop() { listener_->stop(); }

}  // namespace hairbake
