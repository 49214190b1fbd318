#include "server/store/eviction.h"

#include <vector>

namespace hairbake {
namespace {

constexpr const char* live_bake_of_stage =
    "EXISTS(SELECT 1 FROM bakes b WHERE b.transmittance = s.key AND b.state IN ('queued', 'running')) OR "
    "EXISTS(SELECT 1 FROM bakes b WHERE b.irradiance = s.key AND b.state IN ('queued', 'running'))";

/// The stored stage that was used longest ago and that no live bake needs; empty when there is none.
std::string oldest_stage(Sql& sql) {
    const auto rows =
        sql.rows(std::string("SELECT s.key FROM stages s WHERE s.state = 'done' AND NOT (") + live_bake_of_stage +
                 ") ORDER BY (SELECT max(bl.used) FROM stage_files f JOIN blobs bl USING(sha256) "
                 "WHERE f.stage = s.key), s.seq LIMIT 1");
    return rows.empty() ? std::string() : rows[0].text(0);
}

/// Forgets a stage and the bakes that it finished; returns its blobs that nothing else refers to.
std::vector<std::string> forget_stage(Sql& sql, const std::string& key) {
    std::vector<std::string> blobs;
    for (const SqlRow& row :
         sql.rows("SELECT DISTINCT sha256 FROM stage_files f WHERE stage = ? AND NOT EXISTS(SELECT 1 "
                  "FROM stage_files o WHERE o.sha256 = f.sha256 AND o.stage <> f.stage) "
                  "AND sha256 NOT IN (SELECT sha256 FROM stage_inputs) "
                  "AND sha256 NOT IN (SELECT sha256 FROM inputs) "
                  "AND sha256 NOT IN (SELECT sha256 FROM names)",
                  {key}))
        blobs.push_back(row.text(0));
    sql.run("DELETE FROM batch_bakes WHERE bake IN (SELECT id FROM bakes WHERE transmittance = ? OR irradiance = ?)",
            {key, key});
    sql.run("DELETE FROM bakes WHERE transmittance = ?", {key});
    sql.run("DELETE FROM bakes WHERE irradiance = ?", {key});
    sql.run("DELETE FROM stage_files WHERE stage = ?", {key});
    sql.run("DELETE FROM stage_inputs WHERE stage = ?", {key});
    sql.run("DELETE FROM stages WHERE key = ?", {key});
    return blobs;
}

/// The input that was used longest ago and that nothing live refers to; empty when there is none.
std::string oldest_input(Sql& sql, const std::string& spared) {
    const auto rows = sql.rows(
        std::string(
            "SELECT sha256 FROM blobs bl WHERE sha256 <> ? AND "
            "NOT EXISTS(SELECT 1 FROM stage_files f WHERE f.sha256 = bl.sha256) AND "
            "NOT EXISTS(SELECT 1 FROM inputs i WHERE i.thumbnail = bl.sha256) AND "
            "NOT EXISTS(SELECT 1 FROM names n WHERE n.sha256 = bl.sha256 AND n.version = (SELECT max(version) "
            "FROM names m WHERE m.kind = n.kind AND m.path = n.path)) AND "
            "NOT EXISTS(SELECT 1 FROM stage_inputs t JOIN stages s ON s.key = t.stage WHERE t.sha256 = bl.sha256 "
            "AND (") +
            live_bake_of_stage + ")) ORDER BY used LIMIT 1",
        {spared});
    return rows.empty() ? std::string() : rows[0].text(0);
}

std::vector<std::string> forget_input(Sql& sql, const std::string& digest) {
    std::vector<std::string> blobs{digest};
    for (const SqlRow& row :
         sql.rows("SELECT thumbnail FROM inputs i WHERE sha256 = ? AND thumbnail IS NOT NULL AND NOT "
                  "EXISTS(SELECT 1 FROM inputs o WHERE o.thumbnail = i.thumbnail AND o.seq <> i.seq)",
                  {digest}))
        blobs.push_back(row.text(0));
    sql.run("DELETE FROM inputs WHERE sha256 = ?", {digest});
    return blobs;
}

}  // namespace

bool evict(Database& database, BlobStore& store, std::uint64_t budget, const std::string& spared) {
    const auto held = database.lock();  // rows and files go together
    if (store.total_bytes() <= budget) return true;
    store.flush_uses();
    while (store.total_bytes() > budget) {
        std::vector<std::string> blobs;
        database.write([&](Sql& sql) {
            if (const std::string stage = oldest_stage(sql); !stage.empty())
                blobs = forget_stage(sql, stage);
            else if (const std::string input = oldest_input(sql, spared); !input.empty())
                blobs = forget_input(sql, input);
            else
                return;
            blobs.push_back({});  // something was forgotten, be it without a blob of its own
        });
        if (blobs.empty()) return false;
        for (const std::string& digest : blobs)
            if (!digest.empty()) store.remove(digest);
    }
    return true;
}

}  // namespace hairbake
