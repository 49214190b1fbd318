#include "server/jobs/batches.h"

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <unordered_set>

#include "core/base/short_text.h"
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
constexpr std::size_t most_bakes = 100'000, most_listed = 50'000, most_shown = 100, planned_in_one_read = 50;
const std::string up_to_most = " LIMIT " + std::to_string(most_bakes + 1);

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
    if (!body[field].is_array() || body[field].empty() || body[field].size() > most_listed)
        refuse(field, std::string(field) + " is not a list of 1 to 50000 strings");
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

/// `seq` of bakes, each once, in the order in which they were found.
class FoundBakes {
public:
    /// Takes the first column of the rows; returns whether there was one.
    bool add(const std::vector<SqlRow>& rows) {
        for (const SqlRow& row : rows)
            if (known_.insert(row.integer(0)).second) order_.push_back(row.integer(0));
        return !rows.empty();
    }
    const std::vector<std::int64_t>& order() const { return order_; }

private:
    std::unordered_set<std::int64_t> known_;
    std::vector<std::int64_t> order_;
};

/// The bakes that the body selects. Several may lead to the same new request.
std::vector<std::int64_t> affected(Sql& sql, const Json& body) {
    const std::string select = "SELECT seq FROM bakes WHERE hair IS NOT NULL AND ";
    const std::string wanted = select + "state NOT IN ('failed', 'cancelled') AND ";
    FoundBakes found;
    if (body.contains("bakes")) {
        for (const std::string& id : strings(body, "bakes"))
            if (!found.add(sql.rows(select + "id = ?", {id}))) {
                const UnknownBake unknown = describe_unknown_bake(sql, id);
                refuse("bakes", unknown.words + (unknown.was_there ? "" : " with a hair model"));
            }
    } else if (body.contains("models")) {
        for (const std::string& model : strings(body, "models")) {
            const std::string digest = named_digest(sql, model, "model", "models");
            if (!found.add(sql.rows(wanted + "hair = ? ORDER BY seq DESC LIMIT 1", {digest})))
                refuse("models", "there is no bake of the model " + shortened(model, 80));
        }
    } else if (body.contains("replaces")) {
        const std::string digest = named_digest(sql, text(body, "replaces"), "environment", "replaces");
        found.add(sql.rows(wanted + "environment = ? ORDER BY seq" + up_to_most, {digest}));
    } else {
        found.add(sql.rows(wanted +
                               "id IN (SELECT bake FROM bake_names WHERE field = 'environment' AND path = ?) ORDER BY "
                               "seq" +
                               up_to_most,
                           {text(body, "name")}));
    }
    if (found.order().empty())
        refuse(body.contains("name") ? "name" : "replaces", "no bakes of a hair model use this environment");
    if (found.order().size() > most_bakes) throw Refusal(Refused::unprocessable, "more than 100000 bakes are affected");
    return found.order();
}

/// The body without its selection: JSON of the request's form.
std::string changes_in(Json body) {
    for (const char* selection : selections) body.erase(selection);
    return body.dump();
}

/// The body with the first entries of its lists, for the batch's view.
std::string shown_request(Json body) {
    for (const char* list : {"bakes", "models"})
        if (const auto found = body.find(list); found != body.end() && found->size() > most_shown)
            found->erase(found->begin() + most_shown, found->end());
    return body.dump();
}

/// Plans the affected bakes under their new lighting, one at a time.
class Replanning {
public:
    explicit Replanning(const Json& body) : body_(body), changes_(changes_in(body)) {}

    std::vector<std::int64_t> bakes(Sql& sql) const { return affected(sql, body_); }

    /// A bake that was removed since bakes() is passed over.
    void plan(Sql& sql, std::span<const std::int64_t> bakes, const std::function<void(const BakePlan&)>& take) {
        for (const std::int64_t seq : bakes)
            for (const SqlRow& row : sql.rows("SELECT request, names FROM bakes WHERE seq = ?", {seq}))
                take(plan_again(sql, row));
    }
    const std::vector<std::string>& warnings() const { return warnings_; }

private:
    BakePlan plan_again(Sql& sql, const SqlRow& old) {
        AskedBake asked = read_bake_request(sql, old.text(0), changes_);
        warnings_ = std::move(asked.warnings);  // the same for all: of the fields in the body
        BakePlan plan = plan_bake(sql, asked);
        Json names = Json::parse(old.text(1));  // hair and meshes stay those that the names stood for
        names.erase("environment");
        names.update(Json::parse(plan.names));
        plan.names = names.dump();
        return plan;
    }

    const Json& body_;
    const std::string changes_;
    std::vector<std::string> warnings_;
};

/// How many bakes and stages are stored, and how many stages must run.
class Forecast {
public:
    Forecast() {
        for (const Stage& stage : stages()) reused_[std::string(stage.name)] = 0;
        computed_ = reused_;
    }

    void add(Sql& sql, const BakePlan& plan) {
        if (!bakes_.insert(plan.id.substr(0, known_digits)).second) return;
        done_ += !sql.rows("SELECT 1 FROM bakes WHERE id = ? AND state = 'done'", {plan.id}).empty();
        for (const StagePlan& stage : plan.stages) {
            if (!stages_.insert(stage.key.substr(0, known_digits)).second) continue;
            Json& count = (is_stored(sql, stage) ? reused_ : computed_)[stage.kind];
            count = count.get<std::int64_t>() + 1;
        }
    }

    std::string text() const {
        return Json{
            {"bakes", bakes_.size()}, {"done_bakes", done_}, {"reused_stages", reused_}, {"computed_stages", computed_}}
            .dump();
    }

private:
    static constexpr std::size_t known_digits = 15;  // 60 bits of a digest: fits into a string without an allocation

    std::unordered_set<std::string> bakes_, stages_;  ///< beginnings of their ids
    std::int64_t done_ = 0;
    Json reused_ = Json::object(), computed_;  ///< by kind, in the order in which the stages run
};

/// Others read and write meanwhile: a forecast of 100,000 bakes takes many seconds.
std::string forecast(Database& database, Replanning& replanning) {
    std::vector<std::int64_t> bakes;
    database.read([&](Sql& sql) { bakes = replanning.bakes(sql); });
    Forecast forecast;
    for (std::span<const std::int64_t> rest = bakes; !rest.empty();) {
        const auto now = rest.first(std::min(rest.size(), planned_in_one_read));
        database.read(
            [&](Sql& sql) { replanning.plan(sql, now, [&](const BakePlan& plan) { forecast.add(sql, plan); }); });
        rest = rest.subspan(now.size());
    }
    return forecast.text();
}

}  // namespace

Batches::Rebaked Batches::rebake(const std::string& text, bool dry_run) {
    const Json body = parse_body(text);
    Replanning replanning(body);
    if (dry_run) return {{}, forecast(database_, replanning), replanning.warnings()};
    const std::string id = random_name();
    queue_.submit_batch(id, shown_request(body),
                        [&](Sql& sql, const auto& take) { replanning.plan(sql, replanning.bakes(sql), take); });
    return {id, get(id), replanning.warnings()};
}

std::string Batches::get(const std::string& id) {
    if (auto view = views_.find(database_.version(), id)) return std::move(*view);
    std::uint64_t version = 0;
    Json answer;
    database_.read([&](Sql& sql) {
        version = database_.version_read();
        const auto rows = sql.rows("SELECT id, request, created FROM batches WHERE id = ?", {id});
        if (rows.empty())
            throw Refusal(Refused::not_found, "there is no batch " + shortened(id, 64) +
                                                  "; one whose bakes have all ended is forgotten some time later "
                                                  "([store] keep_failed_s)");
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
    views_.keep(version, id, text, text.size());
    return text;
}

}  // namespace hairbake
