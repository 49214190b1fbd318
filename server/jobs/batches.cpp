#include "server/jobs/batches.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "core/request/stages.h"
#include "server/jobs/bake_request.h"
#include "server/jobs/job_state.h"
#include "server/jobs/queue.h"
#include "server/jobs/stage_plan.h"
#include "server/jobs/time_text.h"
#include "server/store/database.h"
#include "server/store/file_system.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t most_bakes = 100'000;

[[noreturn]] void refuse(const std::string& field, const std::string& message) {
    throw Refusal(Refused::unprocessable, message, field);
}

constexpr std::array selections{"bakes", "replaces", "name", "models"};

/// Names of all fields that the body may have.
std::vector<std::string> allowed_fields() {
    std::vector<std::string> fields{"environment", "priority"};
    fields.insert(fields.end(), selections.begin(), selections.end());
    for (const std::string& block : lighting_blocks()) fields.push_back(block);
    return fields;
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

Json parse_body(const std::string& text) {
    Json body = Json::parse(text, nullptr, false);
    if (body.is_discarded()) throw Refusal(Refused::malformed, "the body is not JSON");
    if (!body.is_object()) refuse("", "the body is not a JSON object");
    const std::vector<std::string> allowed = allowed_fields();
    for (const auto& [field, value] : body.items())
        if (std::find(allowed.begin(), allowed.end(), field) == allowed.end())
            refuse(field, field + " is not a field; allowed are " + joined(allowed));
    if (std::count_if(selections.begin(), selections.end(), [&](const char* field) { return body.contains(field); }) !=
        1)
        refuse("bakes", "exactly one of bakes, replaces, name and models selects the bakes");
    if (!body.contains("environment") || !body["environment"].is_string())
        refuse("environment", "environment is missing; allowed is sha256:... or name:...");
    return body;
}

std::vector<std::string> strings(const Json& body, const char* field) {
    std::vector<std::string> list;
    if (!body[field].is_array() || body[field].empty() || body[field].size() > most_bakes)
        refuse(field, std::string(field) + " is not a list of 1 to 100000 strings");
    for (const Json& item : body[field]) {
        if (!item.is_string()) refuse(field, std::string(field) + " is not a list of strings");
        list.push_back(item.get<std::string>());
    }
    return list;
}

std::string text(const Json& body, const char* field) {
    if (!body[field].is_string()) refuse(field, std::string(field) + " is not a string");
    return body[field].get<std::string>();
}

/// Requests and names of the affected bakes. Several may lead to the same new request; rebake() takes each once.
std::vector<SqlRow> affected(Sql& sql, const Json& body) {
    const std::string select = "SELECT request, names FROM bakes WHERE hair IS NOT NULL AND ";
    const std::string wanted = select + "state NOT IN ('failed', 'cancelled') AND ";
    std::vector<SqlRow> rows;
    if (body.contains("bakes")) {
        for (const std::string& id : strings(body, "bakes")) {
            const auto found = sql.rows(select + "id = ?", {id});
            if (found.empty()) refuse("bakes", "there is no bake " + id.substr(0, 64) + " with a hair model");
            rows.push_back(found[0]);
        }
    } else if (body.contains("models")) {
        for (const std::string& model : strings(body, "models")) {
            const std::string digest = named_digest(sql, model, "model", "models");
            const auto found = sql.rows(wanted + "hair = ? ORDER BY seq DESC LIMIT 1", {digest});
            if (found.empty()) refuse("models", "there is no bake of the model " + model.substr(0, 80));
            rows.push_back(found[0]);
        }
    } else if (body.contains("replaces")) {
        const std::string digest = named_digest(sql, text(body, "replaces"), "environment", "replaces");
        rows = sql.rows(wanted + "environment = ? ORDER BY seq", {digest});
    } else {
        rows = sql.rows(
            wanted + "id IN (SELECT bake FROM bake_names WHERE field = 'environment' AND path = ?) ORDER BY seq",
            {text(body, "name")});
    }
    if (rows.empty())
        refuse(body.contains("name") ? "name" : "replaces", "no bakes of a hair model use this environment");
    if (rows.size() > most_bakes) throw Refusal(Refused::unprocessable, "more than 100000 bakes are affected");
    return rows;
}

struct PlannedAgain {
    BakePlan plan;
    std::vector<std::string> warnings;
};

PlannedAgain plan_again(Sql& sql, const SqlRow& old, const Json& body) {
    Json changes = body;
    for (const char* selection : selections) changes.erase(selection);
    const AskedBake asked = read_bake_request(sql, old.text(0), changes.dump());
    BakePlan plan = plan_bake(sql, asked);
    Json names = Json::parse(old.text(1));  // hair and meshes stay those that the names stood for
    names.erase("environment");
    names.update(Json::parse(plan.names));
    plan.names = names.dump();
    return {std::move(plan), asked.warnings};
}

/// How many bakes and stages are stored, and how many stages must run.
Json forecast(Sql& sql, const std::vector<BakePlan>& plans) {
    std::set<std::string> seen;
    const auto done = std::count_if(plans.begin(), plans.end(), [&](const BakePlan& plan) {
        return !sql.rows("SELECT 1 FROM bakes WHERE id = ? AND state = 'done'", {plan.id}).empty();
    });
    Json reused = Json::object();
    for (const Stage& stage : stages()) reused[std::string(stage.name)] = 0;
    Json computed = reused;
    for (const BakePlan& plan : plans)
        for (const StagePlan& stage : plan.stages)
            if (seen.insert(stage.key).second) {
                Json& count = is_stored(sql, stage) ? reused[stage.kind] : computed[stage.kind];
                count = count.get<int>() + 1;
            }
    return {{"bakes", plans.size()}, {"done_bakes", done}, {"reused_stages", reused}, {"computed_stages", computed}};
}

}  // namespace

Batches::Rebaked Batches::rebake(const std::string& text, bool dry_run) {
    const Json body = parse_body(text);
    std::vector<BakePlan> plans;
    std::vector<std::string> warnings;
    Json answer;
    const auto held = database_.lock();  // a stage that is stored now is still stored when its bake is queued
    database_.read([&](Sql& sql) {
        std::set<std::string> seen;
        for (const SqlRow& row : affected(sql, body)) {
            PlannedAgain planned = plan_again(sql, row, body);
            if (seen.insert(planned.plan.id).second) plans.push_back(std::move(planned.plan));
            warnings = std::move(planned.warnings);  // the same for all: of the fields in `body`
        }
        answer = forecast(sql, plans);
    });
    if (dry_run) return {{}, answer.dump(), warnings};
    const std::string id = random_name();
    queue_.submit(plans, id, body.dump());
    return {id, get(id), warnings};
}

std::string Batches::get(const std::string& id) {
    if (auto view = views_.find(database_.version(), id)) return std::move(*view);
    std::uint64_t version = 0;
    Json answer;
    database_.read([&](Sql& sql) {
        version = database_.version_read();
        const auto rows = sql.rows("SELECT id, request, created FROM batches WHERE id = ?", {id});
        if (rows.empty()) throw Refusal(Refused::not_found, "there is no batch " + id.substr(0, 64));
        answer = {{"id", id}, {"created", time_text(rows[0].number(2))}};
        std::int64_t total = 0;
        Json counts = Json::object();
        for (const auto& [state, name] : job_states) counts[std::string(name)] = 0;
        for (const SqlRow& row :
             sql.rows("SELECT b.state, count(*) FROM batch_bakes m JOIN bakes b ON b.seq = m.seq WHERE "
                      "m.batch = ? GROUP BY b.state",
                      {id})) {
            counts[row.text(0)] = row.integer(1);
            total += row.integer(1);
        }
        answer["bakes"] = total;
        answer["states"] = counts;
        answer["request"] = Json::parse(rows[0].text(1));
        answer["links"] = {{"self", "/v1/batches/" + id}, {"bakes", "/v1/bakes?batch=" + id}};
    });
    const std::string text = answer.dump();
    views_.keep(version, id, text);
    return text;
}

}  // namespace hairbake
