#include "server/jobs/bakes.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/digest.h"
#include "server/jobs/bake_manifest.h"
#include "server/jobs/words.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

// 0 id, 1 state, 2 request, 3 names, 4 hair, 5 environment, 6 priority, 7 transmittance, 8 irradiance, 9 attempts, 10
// error, 11 created, 12 finished, 13 seq
constexpr const char* bake_columns =
    "SELECT id, state, request, names, hair, environment, priority, transmittance, irradiance, attempts, error, "
    "created, finished, b.seq FROM bakes b ";

[[noreturn]] void refuse_unknown(const std::string& id) {
    throw Refusal(Refused::not_found, "there is no bake " + id.substr(0, 64));
}

/// State of one stage, how far it is and how long it may still take.
struct StageView {
    Json json;
    double fraction = 0, seconds_left = 0;
};

StageView stage_view(Sql& sql, Queue& queue, const std::string& key) {
    const auto row = sql.rows("SELECT kind, state, attempts, started FROM stages WHERE key = ?", {key}).at(0);
    StageView view{{{"kind", row.text(0)}, {"key", key}, {"state", row.text(1)}, {"attempts", row.integer(2)}}, 0, 0};
    if (row.text(1) == "done") view.fraction = 1;
    if (const auto progress = queue.progress_of(key); progress && row.text(1) == "running") {
        view.fraction = progress->fraction;
        view.json["phase"] = progress->phase;
        if (view.fraction > 0.05) view.seconds_left = (now() - row.number(3)) * (1 - view.fraction) / view.fraction;
    }
    view.json["fraction"] = std::round(view.fraction * 1000) / 1000;
    return view;
}

Json file_links(Sql& sql, const SqlRow& bake) {
    Json files = Json::array();
    const std::string base = "/v1/bakes/" + bake.text(0) + "/files/";
    files.push_back({{"name", "manifest.json"}, {"href", base + "manifest.json"}});
    for (const std::size_t column : {7, 8})
        if (!bake.null(column))
            for (const SqlRow& file :
                 sql.rows("SELECT s.kind, f.name, f.sha256, f.bytes FROM stage_files f JOIN stages s ON "
                          "s.key = f.stage WHERE f.stage = ? ORDER BY f.name",
                          {bake.text(column)})) {
                const std::string name = file_name_in_bake(file.text(0), file.text(1));
                files.push_back(
                    {{"name", name}, {"sha256", file.text(2)}, {"bytes", file.integer(3)}, {"href", base + name}});
            }
    return files;
}

Json short_view(const SqlRow& row) {
    Json json{{"id", row.text(0)},
              {"state", row.text(1)},
              {"model", row.null(4) ? Json() : Json(row.text(4))},
              {"environment", row.null(5) ? Json() : Json(row.text(5))},
              {"priority", row.integer(6)},
              {"attempts", row.integer(9)},
              {"created", time_text(row.number(11))},
              {"finished", row.null(12) ? Json() : Json(time_text(row.number(12)))}};
    json["names"] = Json::parse(row.text(3));
    json["error"] = row.null(10) ? Json() : Json::parse(row.text(10));
    json["links"] = {{"self", "/v1/bakes/" + row.text(0)}};
    return json;
}

/// Of a bake that was asked by several names for one field, the one that the list is about.
void tell_name(Sql& sql, const std::string& path, Json& view) {
    for (const SqlRow& row : sql.rows("SELECT field, version FROM bake_names WHERE bake = ? AND path = ?",
                                      {view["id"].get<std::string>(), path}))
        view["names"][row.text(0)] = {{"path", path}, {"version", row.integer(1)}};
}

struct Selection {
    std::string statement;
    std::vector<SqlValue> values;
};

/// One page of the filtered bakes, and one more. The bakes of a batch or of a name are found by its own index, newest
/// first, and no more of them are read than the page needs; a name may have a bake by several fields.
Selection select_bakes(const BakeFilter& filter) {
    std::string from = "WHERE b.seq < ?", order = " ORDER BY b.seq DESC LIMIT ?";
    if (!filter.batch.empty()) {
        from = "JOIN batch_bakes m ON b.seq = m.seq WHERE m.seq < ? AND m.batch = ?";
        order = " ORDER BY m.seq DESC LIMIT ?";
    } else if (!filter.name.empty()) {
        from = "JOIN bake_names m ON b.seq = m.seq WHERE m.seq < ? AND m.path = ?";
        order = " GROUP BY m.seq ORDER BY m.seq DESC LIMIT ?";
    }
    Selection selection{bake_columns + from, {filter.cursor}};
    const auto add = [&](const std::string& value, const char* condition) {
        if (value.empty()) return;
        selection.statement += condition;
        selection.values.emplace_back(value);
    };
    add(filter.batch, "");
    if (filter.batch.empty())
        add(filter.name, "");
    else
        add(filter.name, " AND b.id IN (SELECT bake FROM bake_names WHERE path = ?)");
    add(filter.state, " AND state = ?");
    add(filter.model, " AND hair = ?");
    add(filter.environment, " AND environment = ?");
    selection.statement += order;
    selection.values.emplace_back(std::int64_t(filter.limit) + 1);
    return selection;
}

Json full_view(Sql& sql, Queue& queue, const SqlRow& row) {
    Json json = short_view(row);
    json["stages"] = Json::array();
    double fraction = 0, seconds_left = 0;
    int stages = 0;
    for (const std::size_t column : {7, 8}) {
        if (row.null(column)) continue;
        const StageView view = stage_view(sql, queue, row.text(column));
        json["stages"].push_back(view.json);
        fraction += view.fraction;
        seconds_left = std::max(seconds_left, view.seconds_left);
        ++stages;
    }
    json["fraction"] = stages ? std::round(fraction / stages * 1000) / 1000 : 0;
    json["seconds_left"] = seconds_left > 0 ? Json(std::ceil(seconds_left)) : Json();
    json["request"] = Json::parse(row.text(2));
    json["files"] = row.text(1) == "done" ? file_links(sql, row) : Json::array();
    return json;
}

std::string stage_manifest(Sql& sql, const SqlRow& bake, std::size_t column) {
    return bake.null(column) ? std::string()
                             : sql.rows("SELECT manifest FROM stages WHERE key = ?", {bake.text(column)}).at(0).text(0);
}

}  // namespace

BakeView Bakes::get(const std::string& id) {
    if (auto view = done_.find(id)) return std::move(*view);
    std::uint64_t version = 0;
    bool done = false;
    BakeView answer;
    database_.read([&](Sql& sql) {
        version = database_.version_read();
        const auto rows = sql.rows(std::string(bake_columns) + "WHERE id = ?", {id});
        if (rows.empty()) refuse_unknown(id);
        answer.json = full_view(sql, queue_, rows[0]).dump();
        done = rows[0].text(1) == "done";
    });
    answer.digest = Digest().add(answer.json).hex();
    if (done) done_.keep(version, id, answer);
    return answer;
}

std::string Bakes::list(const BakeFilter& filter) {
    const Selection selection = select_bakes(filter);
    Json answer{{"bakes", Json::array()}, {"next", nullptr}};
    database_.read([&](Sql& sql) {
        const auto rows = sql.rows(selection.statement, selection.values);
        const auto limit = static_cast<std::size_t>(filter.limit);
        for (std::size_t i = 0; i < std::min(limit, rows.size()); ++i) {
            answer["bakes"].push_back(short_view(rows[i]));
            if (!filter.name.empty()) tell_name(sql, filter.name, answer["bakes"].back());
        }
        if (rows.size() > limit) answer["next"] = std::to_string(rows[limit - 1].integer(13));
    });
    return answer.dump();
}

BakeFile Bakes::file(const std::string& id, const std::string& name) {
    BakeFile file{name, {}, {}, {}};
    database_.read([&](Sql& sql) {
        const auto rows = sql.rows(std::string(bake_columns) + "WHERE id = ?", {id});
        if (rows.empty()) refuse_unknown(id);
        const SqlRow& bake = rows[0];
        if (bake.text(1) != "done")
            throw Refusal(Refused::conflict, "the bake is " + bake.text(1) + "; only a done one has files");
        if (name == "manifest.json") {
            file.text =
                make_bake_manifest(id, bake.text(2), stage_manifest(sql, bake, 7), stage_manifest(sql, bake, 8));
            file.etag = Digest().add(file.text).hex();
            return;
        }
        const Json links = file_links(sql, bake);
        const auto found =
            std::find_if(links.begin(), links.end(), [&](const Json& link) { return link["name"] == name; });
        if (found == links.end()) throw Refusal(Refused::not_found, "the bake has no file " + name.substr(0, 100));
        file.etag = (*found)["sha256"].get<std::string>();
        file.blob = file.etag;
    });
    return file;
}

}  // namespace hairbake
