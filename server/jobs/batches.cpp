#include "server/jobs/batches.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "server/jobs/bake_request.h"
#include "server/jobs/words.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t most_bakes = 100'000;

[[noreturn]] void refuse(const std::string& field, const std::string& message) {
    throw Refusal(Refused::unprocessable, message, field);
}

Json parse_body(const std::string& text) {
    Json body = Json::parse(text, nullptr, false);
    if (body.is_discarded()) throw Refusal(Refused::malformed, "the body is not JSON");
    if (!body.is_object()) refuse("", "the body is not a JSON object");
    static const std::set<std::string> allowed{"environment", "bakes",      "replaces", "name",
                                               "models",      "irradiance", "priority"};
    int sources = 0;
    for (const auto& [field, value] : body.items()) {
        if (!allowed.count(field))
            refuse(field,
                   field +
                       " is not a field; allowed are environment, bakes, replaces, name, models, irradiance, priority");
        if (field == "bakes" || field == "models" || field == "replaces" || field == "name") ++sources;
    }
    if (sources != 1) refuse("bakes", "exactly one of bakes, replaces, name and models says what to bake again");
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

/// The affected bakes' requests and names: the newest for each model and set of settings, as the digest of the new
/// request tells doubles apart anyway.
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
            if (found.empty()) refuse("models", "the model " + model.substr(0, 80) + " was never baked");
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
    if (rows.empty()) refuse(body.contains("name") ? "name" : "replaces", "no bake of a hair model was made under it");
    if (rows.size() > most_bakes) throw Refusal(Refused::unprocessable, "more than 100000 bakes are affected");
    return rows;
}

BakePlan plan_again(Sql& sql, const SqlRow& old, const Json& body) {
    Json request = Json::parse(old.text(0));
    request["environment"] = body["environment"];
    if (body.contains("irradiance")) {
        if (!body["irradiance"].is_object()) refuse("irradiance", "irradiance is not an object");
        request["irradiance"].merge_patch(body["irradiance"]);
    }
    if (body.contains("priority")) request["priority"] = body["priority"];
    BakePlan plan = plan_bake(sql, read_bake_request(sql, request.dump()));
    Json names = Json::parse(old.text(1));  // hair and meshes are those that the names meant
    names.erase("environment");
    names.update(Json::parse(plan.names));
    plan.names = names.dump();
    return plan;
}

/// Which bakes and stages are there and which stages must run.
Json forecast(Sql& sql, const std::vector<BakePlan>& plans) {
    std::set<std::string> seen;
    const auto done = std::count_if(plans.begin(), plans.end(), [&](const BakePlan& plan) {
        return !sql.rows("SELECT 1 FROM bakes WHERE id = ? AND state = 'done'", {plan.id}).empty();
    });
    Json reused{{"transmittance", 0}, {"irradiance", 0}}, computed = reused;
    for (const BakePlan& plan : plans)
        for (const StagePlan* stage : plan.stages())
            if (seen.insert(stage->key).second) {
                Json& count = is_stored(sql, *stage) ? reused[stage->kind] : computed[stage->kind];
                count = count.get<int>() + 1;
            }
    return {{"bakes", plans.size()}, {"done_bakes", done}, {"reused_stages", reused}, {"computed_stages", computed}};
}

}  // namespace

std::string Batches::rebake(const std::string& text, bool dry_run) {
    const Json body = parse_body(text);
    std::vector<BakePlan> plans;
    Json answer;
    const auto held = database_.lock();  // what was found stored stays stored until it is queued
    database_.read([&](Sql& sql) {
        std::set<std::string> seen;
        for (const SqlRow& row : affected(sql, body)) {
            BakePlan plan = plan_again(sql, row, body);
            if (seen.insert(plan.id).second) plans.push_back(std::move(plan));
        }
        answer = forecast(sql, plans);
    });
    if (dry_run) return answer.dump();
    const std::string id = random_name();
    queue_.submit(plans, id, body.dump());
    return get(id);
}

std::string Batches::get(const std::string& id) {
    if (auto view = views_.find(id)) return std::move(*view);
    std::uint64_t version = 0;
    Json answer;
    database_.read([&](Sql& sql) {
        version = database_.version_read();
        const auto rows = sql.rows("SELECT id, request, created FROM batches WHERE id = ?", {id});
        if (rows.empty()) throw Refusal(Refused::not_found, "there is no batch " + id.substr(0, 64));
        answer = {{"id", id}, {"created", time_text(rows[0].number(2))}};
        std::int64_t total = 0;
        Json counts{{"queued", 0}, {"running", 0}, {"done", 0}, {"failed", 0}, {"cancelled", 0}};
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
