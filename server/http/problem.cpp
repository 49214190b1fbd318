#include "server/http/problem.h"

#include <spdlog/spdlog.h>

#include <cerrno>
#include <new>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "server/jobs/service.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

const char* title_of(int status) {
    switch (status) {
        case 400:
            return "Malformed request";
        case 401:
            return "A token is needed";
        case 403:
            return "Not allowed";
        case 404:
            return "Not found";
        case 405:
            return "Method not allowed";
        case 408:
            return "Too slow";
        case 409:
            return "Conflict";
        case 410:
            return "Gone";
        case 411:
            return "Length required";
        case 412:
            return "Precondition failed";
        case 413:
            return "Too large";
        case 414:
            return "Address too long";
        case 415:
            return "Unsupported media type";
        case 416:
            return "Range not satisfiable";
        case 422:
            return "Not acceptable as it is";
        case 429:
            return "Too many";
        case 501:
            return "Not implemented";
        case 503:
            return "Busy";
        case 507:
            return "The store takes no more";
        default:
            return "Internal error";
    }
}

std::string retry_after(const Refusal& refusal, int usual_s) {
    return std::to_string(refusal.retry_s() > 0 ? refusal.retry_s() : usual_s);
}

HttpReply with_needed_by(HttpReply reply, const std::string& list) {
    if (list.empty()) return reply;
    Json body = Json::parse(reply.body);
    body["needed_by"] = Json::parse(list);
    reply.body = body.dump();
    return reply;
}

/// The disk has room, and the daemon's files cannot be written: the operator can change that.
HttpReply unwritable(const std::string& words) { return problem(503, "unwritable", words).with("Retry-After", "5"); }

/// Whether the system forbids or fails to write, other than for lack of room.
bool is_unwritable(const Error& error) {
    const int code = error.system_error();
    return code == EACCES || code == EPERM || code == EROFS || code == EIO;
}

HttpReply problem_of(const Refusal& refusal) {
    switch (refusal.why()) {
        case Refused::malformed:
            return problem(400, "malformed", refusal.what(), refusal.field());
        case Refused::unprocessable:
            return problem(422, "unprocessable", refusal.what(), refusal.field(), refusal.pointer());
        case Refused::not_found:
            return problem(404, "not-found", refusal.what(), refusal.field());
        case Refused::gone:
            return problem(410, "gone", refusal.what(), refusal.field());
        case Refused::conflict:
            return with_needed_by(problem(409, "conflict", refusal.what(), refusal.field()), refusal.needed_by());
        case Refused::too_large:
            return problem(413, "too-large", refusal.what(), refusal.field());
        case Refused::too_many:
            return problem(429, "too-many", refusal.what(), refusal.field())
                .with("Retry-After", retry_after(refusal, 60));
        case Refused::too_slow:
            return problem(408, "too-slow", refusal.what(), refusal.field());
        case Refused::unwritable:
            return unwritable(refusal.what());
        case Refused::full:
            return problem(507, "full", refusal.what(), refusal.field());
        default:
            return problem(503, "busy", refusal.what(), refusal.field()).with("Retry-After", retry_after(refusal, 5));
    }
}

}  // namespace

HttpReply problem(int status, const std::string& slug, const std::string& detail, const std::string& field,
                  const std::string& pointer) {
    Json body{
        {"type", "urn:hairbake:problem:" + slug}, {"title", title_of(status)}, {"status", status}, {"detail", detail}};
    if (!field.empty()) body["field"] = field;
    if (!pointer.empty()) body["pointer"] = pointer;
    HttpReply reply;
    reply.status = status;
    reply.type = "application/problem+json";
    reply.body = body.dump(-1, ' ', false, Json::error_handler_t::replace);
    return reply;
}

HttpReply problem_of_status(int status) {
    // The library answers 416 for a Range that it cannot parse.
    if (status == 416) return problem(400, "malformed", "the header Range cannot be read", "Range");
    if (status == 414) return problem(414, "too-large", "the address is longer than 8192 bytes");
    if (status == 413) return problem(413, "too-large", "the body is longer than allowed");
    if (status < 500) return problem(status, "malformed", "the request cannot be read");
    return problem(status, "internal", "the request could not be handled");
}

HttpReply problem_of_current_exception() {
    try {
        throw;
    } catch (const Refusal& refusal) {
        return problem_of(refusal);
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::out_of_resources)
            return is_unwritable(error) ? unwritable(error.what()) : problem(507, "full", error.what());
        spdlog::error("a request failed: {}", error.what());
    } catch (const std::bad_alloc&) {
        return problem(503, "busy", "memory is short").with("Retry-After", "5");
    } catch (const std::exception& error) {
        spdlog::error("a request failed: {}", error_text(error));
    } catch (...) {
        spdlog::error("a request failed for an unknown reason");
    }
    return problem(500, "internal", "the request could not be handled; the daemon's log has the reason");
}

}  // namespace hairbake
