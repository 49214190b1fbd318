#include "clients/cli/remote/server.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "clients/cli/messages.h"

namespace hairbake {
namespace {

using Json = Server::Json;
constexpr double first_pause_s = 0.1, longest_pause_s = 5;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

bool is_busy(int status) { return status == 408 || status == 429 || status == 502 || status == 503 || status == 504; }

/// The problem+json body, or an empty object.
Json problem_of(const HttpAnswer& answer) {
    try {
        return parse_json(answer.body);
    } catch (const RemoteError&) {
        return Json::object();
    }
}

std::string words_of(const HttpAnswer& answer) {
    const std::string status = "HTTP " + std::to_string(answer.status);
    const Json problem = problem_of(answer);
    const std::string detail = text_in(problem, "detail"), title = text_in(problem, "title");
    if (detail.empty()) return title.empty() ? status : title + " (" + status + ")";
    return detail + " (" + (title.empty() ? "" : title + ", ") + status + ")";
}

std::string advice(int status) {
    if (status == 401) return "; a token is given by --token-file or HAIRBAKE_TOKEN_FILE";
    if (status >= 300 && status < 400) return "; redirects are not followed: give the address that it leads to";
    return "";
}

/// "\n  and 3 more bakes" when the list is not whole.
std::string rest_of(const Json& part, std::size_t shown, const std::string& what) {
    const std::int64_t count =
        part.contains("count") && part["count"].is_number_integer() ? part["count"].get<std::int64_t>() : 0;
    const std::int64_t rest = count - static_cast<std::int64_t>(shown);
    return rest > 0 ? "\n  and " + std::to_string(rest) + " more " + what : "";
}

/// problem.needed_by.FIELD; an empty object when it has another shape.
Json list_in(const Json& problem, const char* field) {
    const Json needed = problem.is_object() ? problem.value("needed_by", Json::object()) : Json::object();
    const Json part = needed.is_object() ? needed.value(field, Json::object()) : Json::object();
    return part.is_object() ? part : Json::object();
}

/// Lines that tell what refers to the input of a refused deletion; empty for other problems.
std::string needed_by(const Json& problem) {
    std::string text;
    const auto add = [&](const char* field, const std::string& more, const auto& line) {
        const Json part = list_in(problem, field);
        const Json first = part.value("first", Json::array());
        for (const Json& entry : first)
            if (entry.is_object()) text += "\n  " + plain(line(entry));
        text += rest_of(part, first.size(), more);
    };
    add("bakes", "bakes",
        [](const Json& bake) { return "bake " + text_in(bake, "id") + " (" + text_in(bake, "state") + ")"; });
    add("names", "versions of names", [](const Json& name) {
        const bool has_version = name.contains("version") && name["version"].is_number_integer();
        const std::string version = has_version ? "@" + name["version"].dump() : "";
        return "name " + text_in(name, "kind") + "/" + text_in(name, "path") + version;
    });
    return text;
}

/// Says what the header Warning has in quotes: 299 - "the request: irradiance.tint is deprecated".
void tell_warning(const HttpAnswer& answer) {
    const std::string header = answer.header("warning");
    const std::size_t begin = header.find('"'), end = header.rfind('"');
    if (begin < end) say_warning(plain(header.substr(begin + 1, end - begin - 1)));
}

}  // namespace

void pause(double seconds, const Progress& progress) {
    for (const double end = now() + seconds; now() < end;) {
        progress.check();
        std::this_thread::sleep_for(std::chrono::duration<double>(std::clamp(end - now(), 0.0, 0.05)));
    }
    progress.check();
}

void Patience::wait(const ConnectionLost& lost) {
    if (failing_since_ < 0) {
        failing_since_ = now();
        pause_ = first_pause_s;
        if (seconds_ > 0)
            say_warning(std::string(lost.what()) + "; retrying for " + std::to_string(std::lround(seconds_)) + " s");
    }
    if (now() - failing_since_ >= seconds_) throw lost;
    pause(pause_, progress_);
    pause_ = std::min(2 * pause_, longest_pause_s);
}

void Patience::renew() { failing_since_ = -1; }

std::string plain(const std::string& text) {
    std::string result = text.substr(0, 1000);
    for (char& c : result)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return result;
}

Server::Server(const ServerOptions& options, BakeProgress& progress)
    : options_(options), progress_(progress), http_(options.url, options.token, options.ca_file) {}

HttpAnswer Server::once(const HttpCall& call) {
    HttpAnswer answer = http_.send(call, progress_);
    if (is_busy(answer.status)) throw ConnectionLost(options_.url + ": " + plain(words_of(answer)));
    return answer;
}

HttpAnswer Server::ask(const HttpCall& call) {
    for (Patience trying = patience();;) try {
            return once(call);
        } catch (const ConnectionLost& lost) {
            trying.wait(lost);
        }
}

Json Server::json(const std::string& method, const std::string& path, const std::string& body) {
    HttpCall call;
    call.method = method;
    call.path = path;
    call.body = body;
    if (!body.empty()) call.headers.emplace_back("Content-Type: application/json");
    const HttpAnswer answer = ask(call);
    if (answer.status < 200 || answer.status > 299) refuse(answer);
    tell_warning(answer);
    return parse_json(answer.body);
}

namespace {

/// What the flags of `hairbake delete` can do about a refused deletion.
std::string deletion_hint(const std::string& field, const std::string& words) {
    if (field == "force") return "\n--force deletes it all the same";
    if (field != "kind") return {};
    for (const auto& [address, kind] : {std::pair("DELETE /v1/models/", "model"),
                                        {"DELETE /v1/environments/", "environment"},
                                        {"DELETE /v1/blobs/", "mesh"}})
        if (words.find(address) != std::string::npos) return std::string("\n--as ") + kind + " deletes it";
    return {};
}

}  // namespace

void refuse(const HttpAnswer& answer) {
    const Json problem = problem_of(answer);
    const std::string field = plain(text_in(problem, "field"));
    std::string words = plain(words_of(answer));
    if (!field.empty() && words.find(field) == std::string::npos) words = field + ": " + words;
    throw RemoteError(
        ExitCode::refused,
        "the server refuses: " + words + advice(answer.status) + needed_by(problem) + deletion_hint(field, words),
        field);
}

Json parse_json(const std::string& text) {
    constexpr int deepest = 64;
    bool deep = false;
    const auto shallow = [&](int depth, Json::parse_event_t, Json&) {
        deep = deep || depth > deepest;
        return !deep;
    };
    Json json = Json::parse(text, shallow, false);
    if (json.is_discarded() || deep)
        throw RemoteError(ExitCode::refused, "the server's answer is not JSON; is it a hairbaked?");
    return json;
}

bool is_id(const std::string& text) {
    const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; };
    return !text.empty() && text.size() <= 128 && std::all_of(text.begin(), text.end(), fits);
}

std::string text_in(const Server::Json& json, const char* field) {
    return json.is_object() && json.contains(field) && json[field].is_string() ? json[field].get<std::string>() : "";
}

std::string id_in(const Json& json, const char* field) {
    std::string id = text_in(json, field);
    if (!is_id(id)) throw RemoteError(ExitCode::refused, std::string("the server's answer has no valid ") + field);
    return id;
}

}  // namespace hairbake
