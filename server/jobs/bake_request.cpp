#include "server/jobs/bake_request.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/request/request_json.h"
#include "server/jobs/names.h"
#include "server/store/blob_store.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

/// What the schema took, or a stored request; malformed only by a mistake of ours.
Json parse(const std::string& body) {
    try {
        return Json::parse(body);
    } catch (const Json::exception& error) {
        throw Refusal(Refused::malformed, std::string("the body is not JSON: ") + error.what());
    }
}

/// "transmittance.voxels" -> "/transmittance/voxels".
std::string pointer_to(std::string field) {
    std::replace(field.begin(), field.end(), '.', '/');
    return field.empty() ? field : std::string(1, '/').append(field);
}

struct Resolved {
    std::string digest;
    Json name;  ///< {"path", "version"} or null
};

Resolved resolve(Sql& sql, const std::string& value, const std::string& kind, const std::string& field) {
    Resolved resolved;
    if (value.starts_with("name:")) {
        const NamedDigest named = Names::resolve(sql, kind, value.substr(5), field);
        resolved = {named.sha256, {{"path", named.path}, {"version", named.version}}};
    } else if (value.starts_with("sha256:") && is_digest(value.substr(7))) {
        resolved.digest = value.substr(7);
    } else {
        throw Refusal(Refused::unprocessable,
                      field + " is neither of what is allowed: sha256: and 64 hexadecimal digits, or name: and a name",
                      field)
            .at("/" + field);
    }
    return resolved;
}

struct FileField {
    const char* name;
    const char* kind;
    std::optional<std::string> BakeRequest::*value;
};

constexpr std::array<FileField, 4> file_fields{{{"hair", "model", &BakeRequest::hair},
                                                {"environment", "environment", &BakeRequest::environment},
                                                {"occluder", "mesh", &BakeRequest::occluder},
                                                {"receiver", "mesh", &BakeRequest::receiver}}};

void resolve_files(Sql& sql, BakeRequest& request, Json& names) {
    for (const FileField& file : file_fields) {
        std::optional<std::string>& value = request.*file.value;
        if (!value) continue;
        const Resolved resolved = resolve(sql, *value, file.kind, file.name);
        value = "sha256:" + resolved.digest;
        if (!resolved.name.is_null()) names[file.name] = resolved.name;
    }
}

int take_priority(Json& body) {
    const auto found = body.find("priority");
    if (found == body.end()) return 0;
    const Json value = *found;
    body.erase("priority");
    if (!value.is_number_integer() || value < -10 || value > 10)
        throw Refusal(Refused::unprocessable,
                      "priority is " + value.dump().substr(0, 40) + "; allowed is an integer from -10 to 10",
                      "priority");
    return value.get<int>();
}

/// What is computed needs its files; what is stored does not.
void check_inputs_stored(Sql& sql, const BakeRequest& request, const StagePlan& stage) {
    if (is_stored(sql, stage)) return;
    for (const FileField& file : file_fields) {
        const std::optional<std::string>& value = request.*file.value;
        if (!value) continue;
        const std::string digest = value->substr(std::strlen("sha256:"));
        if (!std::count(stage.inputs.begin(), stage.inputs.end(), digest)) continue;
        if (sql.rows("SELECT 1 FROM blobs WHERE sha256 = ?", {digest}).empty())
            throw Refusal(Refused::unprocessable,
                          std::string(file.name) + " asks for " + *value + ", which is not stored; send it first",
                          file.name)
                .at(std::string("/") + file.name);
    }
}

}  // namespace

AskedBake read_bake_request(Sql& sql, const std::string& text) {
    Json body = parse(text);
    if (!body.is_object()) throw Refusal(Refused::unprocessable, "the body is not a JSON object");
    AskedBake asked;
    const bool as_it_is = !body.contains("priority");
    asked.priority = take_priority(body);
    Json names = Json::object();
    try {
        merge_json(asked.request, as_it_is ? text : body.dump(-1, ' ', false, Json::error_handler_t::replace),
                   "the request");
        validate(asked.request);
    } catch (const Error& error) {
        throw Refusal(Refused::unprocessable, error.what(), error.field()).at(pointer_to(error.field()));
    }
    resolve_files(sql, asked.request, names);
    asked.names = names.dump();
    return asked;
}

BakePlan plan_bake(Sql& sql, const AskedBake& asked) {
    BakePlan plan = plan_bake(asked.request);
    plan.names = asked.names;
    plan.priority = asked.priority;
    for (const StagePlan* stage : plan.stages()) check_inputs_stored(sql, asked.request, *stage);
    return plan;
}

bool is_stored(Sql& sql, const StagePlan& stage) {
    return !sql.rows("SELECT 1 FROM stages WHERE key = ? AND state = 'done'", {stage.key}).empty();
}

std::string named_digest(Sql& sql, const std::string& value, const std::string& kind, const std::string& field) {
    return resolve(sql, value, kind, field).digest;
}

}  // namespace hairbake
