#include "server/store/pruning.h"

#include "server/store/blob_store.h"

namespace hairbake {
namespace {

constexpr std::int64_t most_forgotten = 100'000;  // bakes, each of some 100 bytes

}  // namespace

void forget_bakes(Sql& sql, const std::vector<SqlRow>& bakes) {
    for (const SqlRow& bake : bakes) {
        const SqlValue seq = bake.integer(0), id = bake.text(1);
        sql.run("INSERT OR REPLACE INTO forgotten_bakes(id, state, time) VALUES(?, ?, ?)", {id, bake.text(2), now()});
        sql.run("DELETE FROM batch_bakes WHERE bake = ?", {id});
        sql.run("DELETE FROM bake_names WHERE bake = ?", {id});
        sql.run("DELETE FROM bake_stages WHERE bake = ?", {seq});
        sql.run("DELETE FROM bakes WHERE seq = ?", {seq});
    }
}

void forget_done_bakes(Sql& sql, const std::string& stage) {
    forget_bakes(sql, sql.rows("SELECT b.seq, b.id, b.state FROM bake_stages m JOIN bakes b ON b.seq = m.bake WHERE "
                               "m.stage = ? AND b.state = 'done'",
                               {stage}));
}

void prune(Database& database, double time) {
    database.write([&](Sql& sql) {
        sql.run(
            "DELETE FROM batches WHERE created < ? AND NOT EXISTS(SELECT 1 FROM batch_bakes m JOIN bakes b "
            "ON b.id = m.bake WHERE m.batch = batches.id AND b.state IN ('queued', 'running'))",
            {time});
        forget_bakes(
            sql, sql.rows("SELECT seq, id, state FROM bakes WHERE state IN ('failed', 'cancelled') AND finished < ?",
                          {time}));
        sql.run("DELETE FROM batch_bakes WHERE batch NOT IN (SELECT id FROM batches)");
        sql.run("DELETE FROM forgotten_bakes WHERE time < ? OR seq <= (SELECT max(seq) FROM forgotten_bakes) - ?",
                {time, most_forgotten});
        sql.run(
            "DELETE FROM stages WHERE state IN ('failed', 'cancelled') AND "
            "NOT EXISTS(SELECT 1 FROM bake_stages m WHERE m.stage = stages.key)");
        sql.run("DELETE FROM stage_inputs WHERE stage NOT IN (SELECT key FROM stages)");
    });
}

}  // namespace hairbake
