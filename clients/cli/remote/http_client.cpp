#include "clients/cli/remote/http_client.h"

#include <curl/curl.h>

#include <algorithm>
#include <cctype>
#include <exception>

namespace hairbake {
namespace {

constexpr long connect_timeout_s = 10;
constexpr long stall_timeout_s = 120;  // the server digests and syncs a large upload before it answers
constexpr long short_call_timeout_s = 300;
constexpr std::size_t most_header_bytes = 256 << 10;

/// The data that the callbacks of one call share.
struct Transfer {
    const HttpCall& call;
    HttpAnswer answer;
    std::size_t header_bytes = 0;
    std::uint64_t body_bytes = 0;
    std::exception_ptr failure;  ///< thrown in a callback: C code must not see it
};

template <class Work>
std::size_t guarded(Transfer& transfer, std::size_t when_failed, Work&& work) {
    try {
        return work();
    } catch (...) {
        transfer.failure = std::current_exception();
        return when_failed;
    }
}

std::string trimmed(const std::string& text) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n"), end = text.find_last_not_of(" \t\r\n");
    return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

void take_header(Transfer& transfer, const std::string& line) {
    transfer.header_bytes += line.size();
    if (transfer.header_bytes > most_header_bytes)
        throw RemoteError(ExitCode::refused, "the headers of the server's answer are too long");
    if (line.starts_with("HTTP/")) transfer.answer.headers.clear();  // 100 Continue came before
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) return;
    std::string name = line.substr(0, colon);
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    transfer.answer.headers[name] = trimmed(line.substr(colon + 1));
}

void take_body(Transfer& transfer, std::span<const std::byte> bytes) {
    transfer.body_bytes += bytes.size();
    if (transfer.body_bytes > transfer.call.most_bytes)
        throw RemoteError(ExitCode::refused, "the server's answer to " + transfer.call.method + " " +
                                                 transfer.call.path + " is too long; allowed are " +
                                                 std::to_string(transfer.call.most_bytes) + " bytes");
    const bool good = transfer.answer.status >= 200 && transfer.answer.status < 300;
    if (transfer.call.sink && good)
        transfer.call.sink(transfer.answer, bytes);
    else
        transfer.answer.body.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

std::size_t on_header(char* data, std::size_t, std::size_t size, void* user) {
    auto& transfer = *static_cast<Transfer*>(user);
    return guarded(transfer, 0, [&] {
        take_header(transfer, std::string(data, size));
        return size;
    });
}

/// Holds the handle, so that the status is known while the body arrives.
struct Receiver {
    Transfer& transfer;
    CURL* easy;
};

std::size_t on_body(char* data, std::size_t, std::size_t size, void* user) {
    const auto& receiver = *static_cast<Receiver*>(user);
    Transfer& transfer = receiver.transfer;
    return guarded(transfer, CURL_WRITEFUNC_ERROR, [&] {
        long status = 0;
        curl_easy_getinfo(receiver.easy, CURLINFO_RESPONSE_CODE, &status);
        transfer.answer.status = static_cast<int>(status);
        take_body(transfer, std::as_bytes(std::span(data, size)));
        return size;
    });
}

std::size_t on_source(char* data, std::size_t, std::size_t size, void* user) {
    auto& transfer = *static_cast<Transfer*>(user);
    return guarded(transfer, CURL_READFUNC_ABORT,
                   [&] { return transfer.call.source(std::as_writable_bytes(std::span(data, size))); });
}

void set_body(CURL* easy, const HttpCall& call, Transfer& transfer) {
    if (call.source) {
        curl_easy_setopt(easy, CURLOPT_UPLOAD, 1L);
        curl_easy_setopt(easy, CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(call.source_bytes));
        curl_easy_setopt(easy, CURLOPT_READFUNCTION, on_source);
        curl_easy_setopt(easy, CURLOPT_READDATA, &transfer);
    } else if (call.method == "HEAD") {
        curl_easy_setopt(easy, CURLOPT_NOBODY, 1L);
    } else if (call.method != "GET" && call.method != "DELETE") {
        curl_easy_setopt(easy, CURLOPT_POSTFIELDS, call.body.c_str());
        curl_easy_setopt(easy, CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(call.body.size()));
    }
    curl_easy_setopt(easy, CURLOPT_CUSTOMREQUEST, call.method.c_str());
}

/// Errors of the connection that a retry does not mend.
bool is_lasting(CURLcode code) {
    switch (code) {
        case CURLE_UNSUPPORTED_PROTOCOL:
        case CURLE_URL_MALFORMAT:
        case CURLE_PEER_FAILED_VERIFICATION:
        case CURLE_SSL_CACERT_BADFILE:
        case CURLE_SSL_CERTPROBLEM:
        case CURLE_SSL_CIPHER:
        case CURLE_OUT_OF_MEMORY:
            return true;
        default:
            return false;
    }
}

}  // namespace

std::string HttpAnswer::header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? "" : found->second;
}

struct HttpClient::Handles {
    CURL* easy = curl_easy_init();
    CURLM* multi = curl_multi_init();
    std::string token, ca_file;
    char message[CURL_ERROR_SIZE] = "";

    ~Handles() {
        curl_easy_cleanup(easy);
        curl_multi_cleanup(multi);
    }

    void prepare() {
        curl_easy_reset(easy);
        message[0] = 0;
        curl_easy_setopt(easy, CURLOPT_ERRORBUFFER, message);
        curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
        curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https");
        curl_easy_setopt(easy, CURLOPT_HTTP_VERSION, static_cast<long>(CURL_HTTP_VERSION_1_1));
        curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT, connect_timeout_s);
        curl_easy_setopt(easy, CURLOPT_LOW_SPEED_LIMIT, 1L);
        curl_easy_setopt(easy, CURLOPT_LOW_SPEED_TIME, stall_timeout_s);
        curl_easy_setopt(easy, CURLOPT_USERAGENT, "hairbake");
        if (!ca_file.empty()) curl_easy_setopt(easy, CURLOPT_CAINFO, ca_file.c_str());
    }

    /// Runs the call that is set up on `easy`. Checks for a cancel every 50 ms.
    CURLcode run(const Transfer& transfer, const Progress& progress) {
        curl_multi_add_handle(multi, easy);
        CURLcode result = CURLE_OK;
        for (int running = 1; running && !progress.cancelled();) {
            if (curl_multi_perform(multi, &running) != CURLM_OK) result = CURLE_FAILED_INIT;
            if (result != CURLE_OK || transfer.failure) break;
            if (running) curl_multi_poll(multi, nullptr, 0, 50, nullptr);
        }
        int left = 0;
        while (const CURLMsg* told = curl_multi_info_read(multi, &left))
            if (told->msg == CURLMSG_DONE) result = told->data.result;
        curl_multi_remove_handle(multi, easy);
        return result;
    }
};

HttpClient::HttpClient(std::string url, const std::string& token, const std::string& ca_file)
    : url_(std::move(url)), handles_(std::make_unique<Handles>()) {
    if (!handles_->easy || !handles_->multi) throw Error(ErrorKind::out_of_resources, "no memory for a connection");
    handles_->token = token;
    handles_->ca_file = ca_file;
}

HttpClient::~HttpClient() = default;

HttpAnswer HttpClient::send(const HttpCall& call, const Progress& progress) {
    Handles& handles = *handles_;
    CURL* const easy = handles.easy;
    Transfer transfer{call, {}, 0, 0, {}};
    Receiver receiver{transfer, easy};
    handles.prepare();
    std::vector<std::string> lines = call.headers;
    if (!handles.token.empty()) lines.push_back("Authorization: Bearer " + handles.token);
    curl_slist* list = curl_slist_append(nullptr, "Accept: */*");
    for (const std::string& line : lines) list = curl_slist_append(list, line.c_str());
    const std::unique_ptr<curl_slist, void (*)(curl_slist*)> headers(list, curl_slist_free_all);
    curl_easy_setopt(easy, CURLOPT_HTTPHEADER, headers.get());
    curl_easy_setopt(easy, CURLOPT_URL, (url_ + call.path).c_str());
    curl_easy_setopt(easy, CURLOPT_HEADERFUNCTION, on_header);
    curl_easy_setopt(easy, CURLOPT_HEADERDATA, &transfer);
    curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_body);
    curl_easy_setopt(easy, CURLOPT_WRITEDATA, &receiver);
    if (!call.source && !call.sink) curl_easy_setopt(easy, CURLOPT_TIMEOUT, short_call_timeout_s);
    set_body(easy, call, transfer);

    const CURLcode code = handles.run(transfer, progress);
    if (transfer.failure) std::rethrow_exception(transfer.failure);
    progress.check();
    if (code != CURLE_OK) {
        const std::string why = handles.message[0] ? handles.message : curl_easy_strerror(code);
        if (is_lasting(code)) throw RemoteError(ExitCode::unreachable, url_ + ": " + why);
        throw ConnectionLost(url_ + ": " + why);
    }
    long status = 0;
    curl_easy_getinfo(easy, CURLINFO_RESPONSE_CODE, &status);
    transfer.answer.status = static_cast<int>(status);
    return transfer.answer;
}

}  // namespace hairbake
