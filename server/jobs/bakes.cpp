#include "server/jobs/bakes.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/digest.h"
#include "core/base/short_text.h"
#include "server/jobs/bake_manifest.h"
#include "server/jobs/bake_records.h"
#include "server/jobs/page.h"
#include "server/jobs/queue.h"
#include "server/jobs/time_text.h"
#include "server/store/blob_store.h"
#include "server/store/database.h"
#include "server/store/refusal.h"

namespace hairbake {
namespace {

using Json = nlohmann::ordered_json;

// 0 id, 1 state, 2 seq, 3 names, 4 hair, 5 environment, 6 priority, 7 attempts, 8 error, 9 created, 10 finished
constexpr const char* short_columns =
    "SELECT id, state, b.seq, names, hair, environment, priority, attempts, error, created, finished FROM bakes b ";
// The same and 11 request, which may have 64 kB
constexpr const char* all_columns =
    "SELECT id, state, b.seq, names, hair, environment, priority, attempts, error, created, finished, request FROM "
    "bakes b ";
// Of the stages of a bake: 0 kind, 1 key, 2 state, 3 attempts, 4 started, 5 manifest
constexpr const char* stage_rows =
    "SELECT s.kind, s.key, s.state, s.attempts, s.started, s.manifest FROM bake_stages m JOIN stages s ON s.key = "
    "m.stage WHERE m.bake = ? ORDER BY m.seq";

std::vector<SqlRow> stages_of(Sql& sql, const SqlRow& bake) { return sql.rows(stage_rows, {bake.integer(2)}); }

/// One stage of a bake.
struct StageView {
    Json json;
    double fraction = 0;      ///< of the stage's work
    double seconds_left = 0;  ///< an estimate; 0 when there is none
};

StageView stage_view(Queue& queue, const SqlRow& row) {
    StageView view{{{"kind", row.text(0)}, {"key", row.text(1)}, {"state", row.text(2)}, {"attempts", row.integer(3)}}};
    const std::optional<JobState> state = job_state(row.text(2));
    if (state == JobState::done) view.fraction = 1;
    if (const auto progress = queue.progress_of(row.text(1)); progress && state == JobState::running) {
        view.fraction = progress->fraction;
        view.json["phase"] = progress->phase;
        if (view.fraction > 0.05) view.seconds_left = (now() - row.number(4)) * (1 - view.fraction) / view.fraction;
    }
    if (state == JobState::queued)
        if (std::string trouble = queue.trouble_of(row.text(1)); !trouble.empty())
            view.json["trouble"] = std::move(trouble);
    view.json["fraction"] = std::round(view.fraction * 1000) / 1000;
    return view;
}

Json file_links(Sql& sql, const SqlRow& bake) {
    Json files = Json::array();
    const std::string base = "/v1/bakes/" + bake.text(0) + "/files/";
    files.push_back({{"name", "manifest.json"}, {"href", base + "manifest.json"}});
    for (const SqlRow& file :
         sql.rows("SELECT m.kind, f.name, f.sha256, f.bytes FROM bake_stages m JOIN stage_files f ON f.stage = m.stage "
                  "WHERE m.bake = ? ORDER BY m.seq, f.name",
                  {bake.integer(2)})) {
        const std::string name = file_name_in_bake(file.text(0), file.text(1));
        files.push_back({{"name", name}, {"sha256", file.text(2)}, {"bytes", file.integer(3)}, {"href", base + name}});
    }
    return files;
}

Json short_view(const SqlRow& row) {
    Json json{{"id", row.text(0)},
              {"state", row.text(1)},
              {"model", row.null(4) ? Json() : Json(row.text(4))},
              {"environment", row.null(5) ? Json() : Json(row.text(5))},
              {"priority", row.integer(6)},
              {"attempts", row.integer(7)},
              {"created", time_text(row.number(9))},
              {"finished", row.null(10) ? Json() : Json(time_text(row.number(10)))}};
    json["names"] = Json::parse(row.text(3));
    json["error"] = row.null(8) ? Json() : Json::parse(row.text(8));
    json["links"] = {{"self", "/v1/bakes/" + row.text(0)}};
    return json;
}

/// A bake may have been asked by several names for one field. The list of a name shows that one.
void show_name(Sql& sql, const std::string& path, Json& view) {
    for (const SqlRow& row : sql.rows("SELECT field, version FROM bake_names WHERE bake = ? AND path = ?",
                                      {view["id"].get<std::string>(), path}))
        view["names"][row.text(0)] = {{"path", path}, {"version", row.integer(1)}};
}

struct Selection {
    std::string statement;
    std::vector<SqlValue> values;
};

/// One page of the filtered bakes, newest first, and one row more, which tells whether there is a next page. The bakes
/// of a batch or a name have indexes of their own, so that only the rows of the page are read. A name may have a bake
/// by several fields, hence GROUP BY.
Selection select_bakes(const BakeFilter& filter) {
    std::string from = "WHERE b.seq < ?", order = " ORDER BY b.seq DESC LIMIT ?";
    if (!filter.batch.empty()) {
        from = "JOIN batch_bakes m ON b.seq = m.seq WHERE m.seq < ? AND m.batch = ?";
        order = " ORDER BY m.seq DESC LIMIT ?";
    } else if (!filter.name.empty()) {
        from = "JOIN bake_names m ON b.seq = m.seq WHERE m.seq < ? AND m.path = ?";
        order = " GROUP BY m.seq ORDER BY m.seq DESC LIMIT ?";
    }
    Selection selection{short_columns + from, {filter.cursor}};
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
    add(filter.state ? name_of(*filter.state) : "", " AND state = ?");
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
    for (const SqlRow& stage : stages_of(sql, row)) {
        const StageView view = stage_view(queue, stage);
        json["stages"].push_back(view.json);
        fraction += view.fraction;
        seconds_left = std::max(seconds_left, view.seconds_left);
        ++stages;
    }
    json["fraction"] = stages ? std::round(fraction / stages * 1000) / 1000 : 0;
    json["seconds_left"] = seconds_left > 0 ? Json(std::ceil(seconds_left)) : Json();
    json["request"] = Json::parse(row.text(11));
    json["files"] = row.text(1) == "done" ? file_links(sql, row) : Json::array();
    return json;
}

std::string manifest_of(Sql& sql, const SqlRow& bake) {
    std::vector<StageManifest> parts;
    for (const SqlRow& stage : stages_of(sql, bake)) parts.push_back({stage.text(0), stage.text(5)});
    return make_bake_manifest(bake.text(0), bake.text(11), parts);
}

}  // namespace

BakeView Bakes::get(const std::string& id) {
    if (auto view = done_.find(database_.version(), id)) return std::move(*view);
    std::uint64_t version = 0;
    bool done = false;
    BakeView answer;
    database_.read([&](Sql& sql) {
        version = database_.version_read();
        const auto rows = sql.rows(std::string(all_columns) + "WHERE id = ?", {id});
        if (rows.empty()) refuse_unknown_bake(sql, id);
        answer.json = full_view(sql, queue_, rows[0]).dump();
        done = rows[0].text(1) == "done";
    });
    answer.digest = Digest().add(answer.json).hex();
    if (done) done_.keep(version, id, answer, answer.json.size());
    return answer;
}

std::string Bakes::list(const BakeFilter& filter) {
    const Selection selection = select_bakes(filter);
    Page page("bakes", filter.limit);
    database_.read([&](Sql& sql) {
        sql.each(selection.statement, selection.values, [&](const SqlRow& row) {
            if (!page.has_room()) return false;
            Json view = short_view(row);
            if (!filter.name.empty()) show_name(sql, filter.name, view);
            page.add(view.dump(), std::to_string(row.integer(2)));
            return true;
        });
    });
    return page.take_text();
}

BakeFile Bakes::file(const std::string& id, const std::string& name) {
    BakeFile file{name, {}, {}, {}};
    database_.read([&](Sql& sql) {
        const auto rows = sql.rows(std::string(all_columns) + "WHERE id = ?", {id});
        if (rows.empty()) refuse_unknown_bake(sql, id);
        const SqlRow& bake = rows[0];
        if (bake.text(1) != "done")
            throw Refusal(Refused::conflict, "the bake is " + bake.text(1) + "; only a done one has files");
        if (name == "manifest.json") {
            file.text = manifest_of(sql, bake);
            file.etag = Digest().add(file.text).hex();
            return;
        }
        const Json links = file_links(sql, bake);
        const auto found =
            std::find_if(links.begin(), links.end(), [&](const Json& link) { return link["name"] == name; });
        if (found == links.end()) throw Refusal(Refused::not_found, "the bake has no file " + shortened(name, 100));
        file.etag = (*found)["sha256"].get<std::string>();
        file.blob = file.etag;
    });
    return file;
}

}  // namespace hairbake
