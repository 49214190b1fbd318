#include "server/jobs/bake_request.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_reason.h"
#include "core/base/short_text.h"
#include "core/request/request_json.h"
#include "core/request/stages.h"
#include "server/jobs/names.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

/// The text passed the schema or was stored, so only a defect of ours makes it malformed.
Json parse(const std::string& body) {
    try {
        return Json::parse(body);
    } catch (const Json::exception& error) {
        throw Refusal(Refused::malformed, "the body is not JSON: " + json_reason(error));
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
        const NamedDigest named = resolve_name(sql, kind, value.substr(5), field);
        resolved = {named.sha256, {{"path", named.path}, {"version", named.version}}};
    } else if (value.starts_with("sha256:") && is_digest(value.substr(7))) {
        resolved.digest = value.substr(7);
    } else {
        throw Refusal(Refused::unprocessable,
                      field + " is \"" + shortened(value, 80) +
                          "\"; allowed is sha256: and 64 hexadecimal digits, or name: and a name",
                      field)
            .at("/" + field);
    }
    return resolved;
}

/// Replaces names by digests; returns the names: {"environment": {"path", "version"}}.
Json resolve_files(Sql& sql, BakeRequest& request) {
    Json names = Json::object();
    for (const FileField& file : file_fields()) {
        std::optional<std::string>& value = request.*file.value;
        if (!value) continue;
        const Resolved resolved = resolve(sql, *value, file.kind, file.name);
        value = "sha256:" + resolved.digest;
        if (!resolved.name.is_null()) names[file.name] = resolved.name;
    }
    return names;
}

/// A body taken apart.
struct Body {
    std::string request;          ///< JSON
    std::optional<int> priority;  ///< as given
};

Body split_body(const std::string& text) {
    Json body = parse(text);
    if (!body.is_object()) throw Refusal(Refused::unprocessable, "the body is not a JSON object");
    const auto found = body.find("priority");
    if (found == body.end()) return {text, std::nullopt};
    const Json value = *found;
    if (!value.is_number_integer() || value < -10 || value > 10)
        throw Refusal(Refused::unprocessable,
                      "priority is " + shortened(value.dump(), 40) + "; allowed is an integer from -10 to 10",
                      "priority");
    body.erase("priority");
    return {body.dump(-1, ' ', false, Json::error_handler_t::replace), value.get<int>()};
}

/// A stage that is stored needs no files any more.
void check_inputs_stored(Sql& sql, const BakeRequest& request, const StagePlan& stage) {
    if (is_stored(sql, stage)) return;
    for (const FileField& file : file_fields()) {
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

namespace {

/// Where the body has the field: at its own place, or at its deprecated one.
std::string place_in(const std::string& body, const std::string& field) {
    const std::string first = first_place_of(field);
    if (first.empty() || first == field) return field;
    return parse(body).contains(Json::json_pointer(pointer_to(first))) ? first : field;
}

}  // namespace

AskedBake read_bake_request(Sql& sql, const std::string& text, const std::optional<std::string>& changes) {
    const Body body = split_body(text), change = changes ? split_body(*changes) : Body();
    AskedBake asked;
    asked.priority = change.priority ? *change.priority : body.priority.value_or(0);
    try {
        asked.warnings = merge_json(asked.request, body.request, "the request");
        if (changes) asked.warnings = merge_json(asked.request, change.request, "the request");
        validate(asked.request);
    } catch (const Error& error) {
        const std::string place = place_in(changes ? *changes : text, error.field());
        throw Refusal(Refused::unprocessable, error.what(), error.field()).at(pointer_to(place));
    }
    asked.names = resolve_files(sql, asked.request).dump();
    return asked;
}

std::vector<std::string> lighting_blocks() {
    const auto blocks_of = [](const Stage& stage) {  // a stage may read some fields of a block alone
        std::vector<std::string> blocks;
        for (const std::string_view setting : stage.settings) blocks.emplace_back(setting.substr(0, setting.find('.')));
        return blocks;
    };
    const auto has = [](const auto& list, std::string_view name) {
        return std::find(list.begin(), list.end(), name) != list.end();
    };
    std::vector<std::string> blocks;
    for (const Stage& stage : stages())
        for (const std::string& block : blocks_of(stage))
            if (has(stage.inputs, "environment") && !has(blocks, block)) blocks.push_back(block);
    for (const Stage& stage : stages())
        if (!has(stage.inputs, "environment"))
            std::erase_if(blocks, [&](const std::string& block) { return has(blocks_of(stage), block); });
    return blocks;
}

BakePlan plan_bake(Sql& sql, const AskedBake& asked) {
    BakePlan plan = plan_bake(asked.request);
    plan.names = asked.names;
    plan.priority = asked.priority;
    for (const StagePlan& stage : plan.stages) check_inputs_stored(sql, asked.request, stage);
    return plan;
}

bool is_stored(Sql& sql, const StagePlan& stage) {
    return !sql.rows("SELECT 1 FROM stages WHERE key = ? AND state = 'done'", {stage.key}).empty();
}

std::string named_digest(Sql& sql, const std::string& value, const std::string& kind, const std::string& field) {
    return resolve(sql, value, kind, field).digest;
}

}  // namespace hairbake
